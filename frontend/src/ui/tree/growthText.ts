import { lookingOnly } from '../../access'
import type { Model } from '../../api/types'
import type { State } from '../../state'
import { withVariant } from '../../studio/variants'
import { text } from '../../text'
import { percent } from '../../text/numbers'
import { judgementOf, makingOf, matchOf } from './figures'
import { type GrowthStatus, growthStatusOf, isBusy } from './growthStatus'

/** Return what goes on while a tree is being made; null while none is. */
export function stepOf(state: State): string | null {
  const status = growthStatusOf(state)
  if (!isBusy(status)) return null
  return state.online ? stepIn(status, state.model?.info ?? null) : text.progress.offline
}

/** Return the sentence above the Grow button: what goes on, what is wrong or missing, or how well the tree fits. */
export function sentenceOf(state: State): string {
  const { faults, sheets, model } = state
  if (faults.grow && sheets) return faults.grow.text
  const status = growthStatusOf(state)
  if (status === 'grown') return matchOf(withVariant(model!.info, model!.variant))
  if (status === 'looking') return text.access.lookingOnly[lookingOnly(state.session)!]
  return stepOf(state) ?? text.grow.status[status as keyof typeof text.grow.status]
}

/** Return what stands beside the sentence: how far the tree is, or what the finished one is made of. */
export function detailsOf(state: State): string {
  const { model, faults, online } = state
  const status = growthStatusOf(state)
  if (!model || faults.grow) return ''
  if (status === 'growing') return online ? progressOf(model.info) : ''
  return status === 'grown' ? makingOf(withVariant(model.info, model.variant)) : ''
}

/** Return how growing ended; empty where nothing needs to be said. */
export function endOf(state: State): string {
  const { faults, model } = state
  if (faults.grow) return faults.grow.text
  if (growthStatusOf(state) === 'canceled') return text.grow.status.canceled
  if (model?.info.status !== 'succeeded') return ''
  const { score } = model.info
  return score ? text.progress.done(matchOf(model.info), judgementOf(model.info)) : text.grow.status.grown
}

/** Return how far a tree is: per cent, and the time that is left where it is known. */
export function progressOf({ progress, eta_s: left }: Model): string {
  const share = Math.floor(progress * 100) / 100
  return left === null || left < 1 ? percent(share) : text.progress.percentAndTime(share, left)
}

function stepIn(status: GrowthStatus, model: Model | null): string {
  if (status === 'asking' || !model) return text.grow.status.asking
  const step = status === 'queued' ? placeOf(model.queue_position) : phaseOf(model.phase)
  return model.attempt > 1 ? text.progress.attempt(step, model.attempt) : step
}

function placeOf(place: number | null): string {
  return place === null || place <= 1 ? text.progress.next : text.progress.queued(place - 1)
}

function phaseOf(phase: string | null): string {
  return phase === null ? text.progress.starting : (text.progress.phases[phase] ?? phase)
}
