import { isOver } from '../api/follow'
import type { Model } from '../api/types'
import type { State } from '../state'
import { text } from '../text'
import { isOfFile, sameValue } from './settingGroups'

/** Where growing stands, as the page says it. */
export type Standing =
  | 'noPhoto'
  | 'noCrown'
  | 'noTrunk'
  | 'noFront'
  | 'noSense'
  | 'ready'
  | 'asking'
  | 'queued'
  | 'growing'
  | 'bringing'
  | 'grown'
  | 'strokesChanged'
  | 'settingsChanged'
  | 'filesChanged'
  | 'failed'
  | 'canceled'

const BUSY: readonly Standing[] = ['asking', 'queued', 'growing']

/** Tell where growing stands. */
export function standingOf(state: State): Standing {
  const { asking, model, photo } = state
  if (asking) return 'asking'
  if (model && !isOver(model)) return model.status === 'queued' ? 'queued' : 'growing'
  if (!photo) return 'noPhoto'
  const { crown, branches } = state.history.present
  if (state.source === 'sketch' && !branches.length) return 'noFront'
  if (state.source === 'photo' && !crown) return 'noCrown'
  if (!branches.length) return 'noTrunk'
  if (state.faults.strokes?.stroke) return 'noSense'
  return model ? standingOfEnded(state, model) : 'ready'
}

/** Tell whether a tree is on its way, so that no other can be asked for. */
export function isBusy(standing: Standing): boolean {
  return BUSY.includes(standing)
}

/** Tell whether Grow would do something. */
export function canGrow(standing: Standing): boolean {
  return !isBusy(standing) && !standing.startsWith('no')
}

/** Say what goes on while a tree is on its way. */
export function stepOf(standing: Standing, model: Model | null): string {
  if (standing === 'asking' || !model) return text.grow.standing.asking
  const step = standing === 'queued' ? placeOf(model.queue_position) : phaseOf(model.phase)
  return model.attempt > 1 ? text.progress.takenUpAgain(step) : step
}

/** Say how far it is: per cent, and the time that is left where it is known. */
export function figuresOf({ progress, eta_s: left }: Model): string {
  const percent = text.progress.percent(Math.floor(progress * 100))
  return left === null || left < 1 ? percent : `${percent} · ${text.progress.left(timeOf(left))}`
}

function standingOfEnded({ modelOf, history, tree, faults, ...state }: State, model: Model): Standing {
  const sameStrokes = modelOf === history.present
  if (model.status !== 'succeeded') return sameStrokes ? (model.status as 'failed' | 'canceled') : 'ready'
  if (!tree && !faults.grow) return 'bringing'
  if (!sameStrokes) return 'strokesChanged'
  const wished: Readonly<Record<string, unknown>> = state.settings
  const changed = Object.keys(wished).filter(name => !sameValue(wished[name], model.settings[name] ?? wished[name]))
  const ownChanged = state.leaf !== state.modelLeaf || state.fruit !== state.modelFruit
  if (state.seed !== model.seed || ownChanged) return 'settingsChanged'
  if (!changed.length) return 'grown'
  return changed.every(name => isOfFile(state.limits, name)) ? 'filesChanged' : 'settingsChanged'
}

function placeOf(place: number | null): string {
  return place === null || place <= 1 ? text.progress.next : text.progress.queued(ordinal(place))
}

function phaseOf(phase: string | null): string {
  return phase === null ? text.progress.starting : (text.progress.phases[phase] ?? phase)
}

function ordinal(place: number): string {
  const endings: Readonly<Record<string, string>> = { one: 'st', two: 'nd', few: 'rd' }
  return `${place}${endings[new Intl.PluralRules('en', { type: 'ordinal' }).select(place)] ?? 'th'}`
}

function timeOf(seconds: number): string {
  return seconds < 90 ? `${Math.round(seconds)} s` : `${Math.round(seconds / 60)} min`
}
