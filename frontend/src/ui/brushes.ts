import { isPaper } from '../sheets'
import type { Studio } from '../studio/studio'
import { text } from '../text'
import { button, el, icon } from './dom'
import { ICONS } from './icons'

const { brushes: words } = text.sheets

/** How wide each brush is, as a share of the paper's height; a pencil has no width. */
export const BRUSHES = [
  [null, words.pencil],
  [0.008, words.fine],
  [0.018, words.medium],
  [0.036, words.broad],
] as const
/** A brush's width as it is shown, CSS px for all of the paper's height. */
const SHOWN = 480

/** Make what lies at the foot of the drawing: the choice of the brush on paper, or the way to the left side's sheet. */
export function deskFoot(studio: Studio): HTMLElement {
  const { store, desk } = studio
  const open = button({ class: 'button outlined side-opener', title: text.sheets.openWhy }, () => desk.openSide())
  open.append(icon(ICONS.sheet), text.sheets.open)
  const bar = el('div', { class: 'brushes', role: 'group', 'aria-label': words.group }, ...BRUSHES.map(brushButton))
  store.watch(
    state => state,
    state => {
      bar.hidden = !isPaper(state, state.sheet)
      const { branches } = state.history.present
      open.hidden = state.source === 'sketch' || state.side !== null || branches.length === 0
    },
  )
  return el('div', { class: 'desk-foot' }, bar, open)

  function brushButton([brush, label]: (typeof BRUSHES)[number]): HTMLElement {
    const made = button({ class: 'button square', title: label, 'aria-label': label }, () => desk.takeBrush(brush))
    const dot = el('span', { class: 'brush-dot' })
    dot.style.setProperty('--dot', `${(brush ?? 0) * SHOWN}px`)
    made.append(brush === null ? icon(ICONS.pencil) : dot)
    store.watch(
      state => state.brush === brush && state.tool === 'branch',
      held => made.setAttribute('aria-pressed', String(held)),
    )
    return made
  }
}

/** Name the brush so many steps wider than another; the thinnest and the widest stay what they are. */
export function nextBrush(brush: number | null, steps: number): number | null {
  const at = BRUSHES.findIndex(([width]) => width === brush)
  return BRUSHES[Math.min(Math.max(at + steps, 0), BRUSHES.length - 1)]![0]
}
