import { el } from './dom'
import './popover.css'

let made = 0
const GAP_PX = 6

/** Make `opener` open a panel below or above it; Escape and a click elsewhere close the panel. */
export function popover(opener: HTMLButtonElement, ...content: readonly Node[]): HTMLElement {
  const id = `panel-${++made}`
  const panel = el('div', { id, class: 'popover', popover: 'auto' }, ...content)
  opener.setAttribute('popovertarget', id)
  panel.addEventListener('toggle', event => {
    if ((event as ToggleEvent).newState === 'open') place(panel, opener.getBoundingClientRect())
  })
  return panel
}

function place(panel: HTMLElement, { left, right, top, bottom }: DOMRect): void {
  const { clientWidth, clientHeight } = document.documentElement
  const { width, height } = panel.getBoundingClientRect()
  const start = (left + right) / 2 > clientWidth / 2 ? right - width : left
  const below = bottom + GAP_PX + height <= clientHeight || top < clientHeight / 2
  panel.style.left = `${Math.max(GAP_PX, Math.min(start, clientWidth - width - GAP_PX))}px`
  panel.style.top = `${below ? bottom + GAP_PX : Math.max(GAP_PX, top - height - GAP_PX)}px`
}
