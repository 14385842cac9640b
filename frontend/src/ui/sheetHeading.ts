import { groundOf, isPaper } from '../sheets'
import type { State } from '../state'
import type { SheetName } from '../strokes'
import type { Studio } from '../studio/studio'
import { text } from '../text'
import { button, el, icon, svg } from './dom'
import { ICONS } from './icons'
import { choosePicture, chooseSketch } from './intake'

const { sheets: words } = text

/** Make a sheet's heading: which side it shows, from where it is seen, and the picture that lies under its strokes. */
export function sheetHeading({ store, desk, opener }: Studio, sheet: SheetName): HTMLElement {
  const square = (label: string, path: string, act: () => void) =>
    button({ class: 'button square', 'aria-label': label, title: label }, act, icon(path))
  const lay = square(words.lay, ICONS.photo, () => choosePicture(file => void desk.lay(sheet, file)))
  const bring = square(words.openDrawing, ICONS.drawing, () => chooseSketch(file => void opener.openOn(sheet, file)))
  const hide = square(words.hide, ICONS.eye, () => desk.show(sheet, hidden()))
  const lift = square(words.lift, ICONS.remove, () => desk.lift(sheet))
  const close = square(words.close, ICONS.cross, () => desk.closeSide())
  close.hidden = sheet === 'front'
  const name = el('h2', { title: words.seenLong[sheet] }, words[sheet])
  const seen = el('p', { class: 'soft', title: words.seenLong[sheet] }, words.seen[sheet])
  const tools = el('div', { class: 'sheet-tools' }, bring, lay, hide, lift, close)
  const heading = el('div', { class: 'sheet-heading' }, compass(sheet), name, seen, tools)
  store.watch(
    state => state,
    state => {
      const ground = groundOf(state, sheet)
      heading.hidden = !hasHeading(state)
      heading.classList.toggle('active', state.sheet === sheet)
      bring.hidden = !isPaper(state, sheet)
      lay.hidden = !isPaper(state, sheet) || Boolean(ground?.url)
      hide.hidden = lift.hidden = !isPaper(state, sheet) || !ground?.url
      hide.ariaLabel = hide.title = ground?.hidden ? words.show : words.hide
      hide.setAttribute('aria-pressed', String(!ground?.hidden))
    },
  )
  return heading

  function hidden(): boolean {
    return Boolean(groundOf(store.state, sheet)?.hidden)
  }
}

function hasHeading({ source, side }: State): boolean {
  return source === 'sketch' || side !== null
}

/** Show the tree from above, and the eye that looks at it: from below in front, from the left at the side. */
function compass(sheet: SheetName): SVGElement {
  const eye = sheet === 'front' ? 'M12 22.5 9 18h6zM12 18v-2.5' : 'M1.5 12 6 9v6zM6 12h2.5'
  const picture = svg('svg', { viewBox: '0 0 24 24', class: 'icon compass', 'aria-hidden': 'true' })
  picture.append(svg('circle', { cx: 12, cy: 12, r: 4.5 }), svg('path', { class: 'compass-eye', d: eye }))
  return picture
}
