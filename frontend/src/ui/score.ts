import type { Model } from '../api/types'
import type { Store } from '../state'
import { aloneOf } from '../studio/variants'
import { text } from '../text'
import { el } from './dom'
import { type Figure, figuresOfModel, judgementOf } from './figures'
import { type Measure, measuresOf } from './measures'
import { makePanel } from './panel'
import './score.css'

/** A value of more letters has a line of its own. */
const LONG = 20

/** Make the panel that says how well the model turned out and what it measures, each figure with what it means. */
export function scorePanel(store: Store): HTMLElement {
  const judgement = el('p', { class: 'judgement' })
  const rows = el('dl', { class: 'figures' })
  const list = el('dl', { class: 'measures' })
  const heading = el('h3', { class: 'measures-title', id: 'measures' }, text.score.measures.title)
  const lead = el('p', { class: 'soft measures-lead' }, text.score.measures.lead)
  const measures = el('section', { 'aria-labelledby': 'measures' }, heading, lead, list)
  store.watch(looked(), model => {
    const all = model ? measuresOf(model) : []
    judgement.textContent = model?.score ? judgementOf(model) : ''
    rows.replaceChildren(...(model ? figuresOfModel(model) : []).map(figureRow))
    list.replaceChildren(...all.map(measureRow))
    measures.hidden = all.length === 0
  })
  return makePanel('score', text.score.title, judgement, rows, measures)
}

/** Select the tree that is looked at, anew only where its report or the choice changes. */
function looked(): (state: Store['state']) => Model | null {
  let known: { report: unknown; variant: number; model: Model | null } | null = null
  return ({ model, variant }) => {
    const report = model?.report ?? null
    if (known?.report === report && known.variant === variant) return known.model
    known = { report, variant, model: model && aloneOf(model, variant) }
    return known.model
  }
}

function figureRow({ label, value, why }: Figure): HTMLElement {
  const meaning = el('dd', { class: 'figure-why' }, why)
  return el('div', { class: 'figure' }, el('dt', {}, label), el('dd', { class: 'figure-value' }, value), meaning)
}

function measureRow({ name, label, value, range, basis, why }: Measure): HTMLElement {
  const sure = basis && el('span', { class: 'measure-basis', title: basis[1] }, basis[0])
  const between = range ? el('span', { class: 'measure-range' }, range) : null
  return el(
    'div',
    { class: value.length > LONG ? 'measure long' : 'measure', 'data-measure': name },
    el('dt', {}, label),
    el('dd', { class: 'measure-value' }, el('span', {}, value), between),
    el('dd', { class: 'measure-sure' }, sure),
    el('dd', { class: 'figure-why' }, why),
  )
}
