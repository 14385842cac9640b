import type { State } from '../state'
import type { Studio } from '../studio/studio'
import { aloneOf } from '../studio/variants'
import { text } from '../text'
import { button, el } from './dom'
import { makingOf, matchOf } from './figures'
import { opening } from './panel'
import { canGrow, figuresOf, isBusy, standingOf, stepOf } from './standing'
import { setShown } from './vanish'

/** What the line that says where growing stands is tied to. */
interface Ties {
  /** Of its words. */
  readonly id: string
  readonly score: HTMLElement
  /** Where the focus goes when the button that had it vanishes. */
  readonly grow: HTMLElement
}

/** Make the line that says where growing stands, what is wrong, and what can be done about it. */
export function standingLine(studio: Studio, { id, score, grow }: Ties): HTMLElement {
  const { store, grower } = studio
  const words = el('p', { class: 'standing-words', id })
  const figures = el('span', { class: 'standing-figures' })
  const cancel = button({ class: 'button outlined' }, () => void grower.cancel(), text.grow.cancel)
  const again = button({ class: 'button outlined' }, () => void grower.grow(), text.grow.tryAgain)
  const details = button({ class: 'button outlined', ...opening(score) }, () => {}, text.score.details)
  const said = el('div', { class: 'standing-said' }, words, figures)
  const line = el('div', { class: 'standing' }, said, cancel, again, details)
  store.watch(
    state => state,
    state => {
      const standing = standingOf(state)
      const fault = state.faults.grow && state.photo
      put(words, sentenceOf(state))
      put(figures, figuresBeside(state))
      words.classList.toggle('fault', Boolean(fault))
      setShown(cancel, standing === 'queued' || standing === 'growing', grow)
      setShown(again, Boolean(fault) && canGrow(standing), grow)
      setShown(details, state.model?.status === 'succeeded' && !isBusy(standing) && !fault, grow)
    },
  )
  return line
}

/** Make the bar that shows how far the tree on its way is; it takes no room of its own. */
export function progressBar({ store }: Studio): HTMLElement {
  const done = el('div', { class: 'progress-done' })
  const bar = el('div', { class: 'progress', role: 'progressbar', 'aria-label': text.progress.label }, done)
  store.watch(
    state => state,
    state => {
      const standing = standingOf(state)
      const known = standing === 'growing' || standing === 'bringing'
      const percent = standing === 'bringing' ? 100 : Math.floor((state.model?.progress ?? 0) * 100)
      bar.hidden = !isBusy(standing) && standing !== 'bringing'
      bar.classList.toggle('unknown', !known)
      if (known) bar.setAttribute('aria-valuenow', String(percent))
      else bar.removeAttribute('aria-valuenow')
      done.style.setProperty('--done', String(percent / 100))
    },
  )
  return bar
}

function sentenceOf(state: State): string {
  const standing = standingOf(state)
  const busy = isBusy(standing)
  if (state.faults.grow && state.photo) return state.faults.grow.text
  if (busy && !state.online) return text.progress.offline
  if (standing === 'asking' || standing === 'queued' || standing === 'growing') return stepOf(standing, state.model)
  return standing === 'grown' && state.model
    ? matchOf(aloneOf(state.model, state.variant))
    : text.grow.standing[standing]
}

/** Give what stands beside the sentence: how far it is, or what the finished tree is made of. */
function figuresBeside(state: State): string {
  const standing = standingOf(state)
  const { model } = state
  if (!model || state.faults.grow) return ''
  if (standing === 'growing') return state.online ? figuresOf(model) : ''
  return standing === 'grown' ? makingOf(aloneOf(model, state.variant)) : ''
}

/** Change a text only where it changes, so that nothing is drawn or read anew for nothing. */
function put(element: HTMLElement, sentence: string): void {
  if (element.textContent !== sentence) element.textContent = sentence
}
