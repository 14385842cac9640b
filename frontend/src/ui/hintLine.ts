import type { PointerKind } from '../sketch/gesture'
import type { Studio } from '../studio/studio'
import { text } from '../text'
import { button, el } from './dom'
import { type Hint, hintOf } from './hint'
import './hintLine.css'

/** Show the one line that says what comes next, with what can be done about it at once. */
export function mountHintLine(studio: Studio, host: HTMLElement): void {
  const { store } = studio
  let pointer: PointerKind = matchMedia('(pointer: coarse)').matches ? 'touch' : 'mouse'
  let shown = ''
  const line = el('div', { class: 'hint' })
  const show = () => {
    const hint = hintOf(store.state, pointer)
    const key = JSON.stringify(hint)
    if (key === shown) return
    shown = key
    line.dataset.tone = hint.tone
    line.replaceChildren(sentence(hint), ...actions(hint, studio))
  }
  const tracing = el('p', { class: 'hint-tracing', 'aria-hidden': 'true' }, text.hints.tracing)
  host.append(el('div', { class: 'hint-over' }, line, tracing))
  store.watch(state => state, show)
  store.watch(
    state => state.tracing,
    tracing => host.classList.toggle('is-tracing', tracing),
  )
  addEventListener('pointerdown', event => {
    pointer = event.pointerType as PointerKind
    show()
  })
}

function sentence({ tone, text: said, how }: Hint): HTMLElement {
  const role = tone === 'fault' ? 'alert' : undefined
  return el(
    'p',
    { class: 'hint-text', role },
    el('strong', {}, said),
    how ? el('span', { class: 'hint-how' }, ` ${how}`) : null,
  )
}

function actions(hint: Hint, { sketchbook }: Studio): HTMLElement[] {
  const { stroke } = hint
  const small = (label: string, act: () => void) => button({ class: 'button outlined small' }, act, label)
  const dropStroke = () => {
    sketchbook.select(stroke!)
    sketchbook.remove()
  }
  return [
    ...(stroke ? [small(text.hints.deleteStroke, dropStroke)] : []),
    ...(hint.tone === 'fault' ? [small(text.hints.undo, () => sketchbook.undo())] : []),
    ...(hint.deletes ? [small(text.hints.delete, () => sketchbook.remove())] : []),
  ]
}
