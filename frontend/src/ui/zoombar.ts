import { text } from '../text'
import { button, el, icon } from './dom'
import { ICONS } from './icons'

/** What the bar does to the photo's view. */
export interface Zoomed {
  fit(): void
  actual(): void
  zoom(factor: number): void
}

const FACTOR = 1.25

/** Make the bar that zooms the photo, and what tells it the scale in CSS pixels per photo pixel. */
export function zoombar(zoomed: () => Zoomed): { bar: HTMLElement; show(scale: number): void } {
  const square = (label: string, path: string, act: () => void) =>
    button({ class: 'button square', title: label, 'aria-label': label }, act, icon(path))
  const percent = button({ class: 'button zoom-percent' }, () => zoomed().actual())
  const fit = button({ class: 'button zoom-fit', title: text.tools.withKey(text.tools.fitWhole, 'F') }, () =>
    zoomed().fit(),
  )
  fit.append(icon(ICONS.fit), el('span', { class: 'tool-label' }, text.tools.fit))
  const bar = el(
    'div',
    { class: 'zoombar', role: 'group', 'aria-label': text.tools.zoom },
    square(text.tools.withKey(text.tools.zoomOut, '−'), ICONS.minus, () => zoomed().zoom(1 / FACTOR)),
    percent,
    square(text.tools.withKey(text.tools.zoomIn, '+'), ICONS.plus, () => zoomed().zoom(FACTOR)),
    fit,
  )
  const show = (scale: number) => {
    const rounded = Math.round(scale * 100)
    percent.textContent = text.tools.percent(rounded)
    percent.ariaLabel = text.tools.actual(rounded)
    percent.title = text.tools.toActual
  }
  return { bar, show }
}
