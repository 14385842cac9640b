import type { StrokeWarning } from './api/types'
import type { State } from './state'
import { type StrokeRef, strokeAt } from './strokes'

/** Codes of the warnings that are doubts: that a stroke may not mean a tree. */
const DOUBTS = ['outside_photo', 'crown_unclear', 'trunk_unclear']

/** A warning of the service, and the stroke that it is about. */
export interface StrokeRemark {
  readonly warning: StrokeWarning
  readonly stroke: StrokeRef | null
}

/** Return the service's warnings about the present strokes; none while these are not traced. */
export function remarksOn({ traced, history }: Pick<State, 'traced' | 'history'>): StrokeRemark[] {
  if (traced?.of !== history.present) return []
  return traced.answer.warnings.map(warning => ({
    warning,
    stroke: strokeAt(`/${warning.stroke}`, history.present.views),
  }))
}

/** Return the first doubt about the present strokes; null where there is none. */
export function doubtIn(state: State): StrokeRemark | null {
  return remarksOn(state).find(({ warning }) => DOUBTS.includes(warning.code)) ?? null
}
