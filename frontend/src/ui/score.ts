import type { Store } from '../state'
import { text } from '../text'
import { el } from './dom'
import { type Figure, figuresOfModel, judgementOf } from './figures'
import { makePanel } from './panel'

/** Make the panel that says how well the model turned out, each figure with what it means. */
export function scorePanel(store: Store): HTMLElement {
  const judgement = el('p', { class: 'judgement' })
  const rows = el('dl', { class: 'figures' })
  store.watch(
    state => state.model?.report,
    () => {
      const { model } = store.state
      judgement.textContent = model?.score ? judgementOf(model) : ''
      rows.replaceChildren(...(model ? figuresOfModel(model) : []).map(figureRow))
    },
  )
  return makePanel('score', text.score.title, judgement, rows)
}

function figureRow({ label, value, why }: Figure): HTMLElement {
  const meaning = el('dd', { class: 'figure-why' }, why)
  return el('div', { class: 'figure' }, el('dt', {}, label), el('dd', { class: 'figure-value' }, value), meaning)
}
