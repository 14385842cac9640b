import { remarksOn } from '../doubts'
import type { State } from '../state'
import { type StrokeRef, strokeRefs } from '../strokes'
import type { Studio } from '../studio/studio'
import { text } from '../text'
import { button, el, icon } from './dom'
import { remarkText } from './hint'
import { ICONS } from './icons'
import { popover } from './popover'
import { strokeName } from './strokeNames'
import './strokeList.css'

/** Make the button that opens the list of all strokes, and the list. */
export function strokeList(studio: Studio): HTMLElement[] {
  const { store } = studio
  const opener = button({ class: 'button tool' }, () => {}, icon(ICONS.list))
  const rows = el('ul', { class: 'stroke-rows', tabindex: -1 })
  const panel = popover(opener, el('h2', { class: 'stroke-title' }, text.strokes.title), rows)
  panel.setAttribute('aria-label', text.strokes.title)
  const show = (state: State) => {
    const refs = strokeRefs(state.history.present)
    const label = text.strokes.button(refs.length)
    opener.title = label
    opener.ariaLabel = label
    const focused = [...rows.children].findIndex(row => row.contains(document.activeElement))
    const empty = el('li', { class: 'stroke-none' }, text.strokes.none)
    rows.replaceChildren(...(refs.length ? refs.map(ref => row(ref, state, studio)) : [empty]))
    if (focused >= 0) refocus(rows, focused)
  }
  store.watch(
    state => state.history.present,
    () => show(store.state),
  )
  store.watch(
    state => state.selection,
    () => show(store.state),
  )
  store.watch(
    state => state.traced,
    () => show(store.state),
  )
  return [opener, panel]
}

function row(ref: StrokeRef, state: State, { sketchbook }: Studio): HTMLElement {
  const { selection, history } = state
  const name = strokeName(ref)
  const said = remarksOn(state).filter(({ stroke }) => stroke && same(stroke, ref))
  const { scale } = history.present
  const shown = ref.kind === 'scale' && scale ? text.strokes.scaleOf(text.metres(scale.metres)) : name
  const chosen = selection?.kind === ref.kind && 'index' in selection && selection.index === ref.index
  const remove = () => {
    sketchbook.select(ref)
    sketchbook.remove()
  }
  return el(
    'li',
    { class: 'stroke-row', 'data-kind': ref.kind },
    button(
      { class: 'button stroke-name', 'aria-pressed': String(chosen) },
      () => sketchbook.select(chosen ? null : ref),
      shown,
    ),
    button({ class: 'button square', 'aria-label': text.strokes.delete(name) }, remove, icon(ICONS.remove)),
    ...said.map(remark => el('p', { class: 'stroke-remark' }, remarkText(remark))),
  )
}

function same(one: StrokeRef, other: StrokeRef): boolean {
  return one.kind === other.kind && one.index === other.index && one.sheet === other.sheet
}

/** Keep the focus near where it was when the rows change beneath it. */
function refocus(rows: HTMLElement, index: number): void {
  const row = rows.children[Math.min(index, rows.children.length - 1)]
  ;(row?.querySelector('button') ?? rows).focus()
}
