import type { StrokeWarning } from './api/types'
import type { State } from './state'
import { type StrokeRef, strokeAt } from './strokes'

/** Codes of warnings that a stroke may mean no tree. */
const DOUBTS = ['trunk_level', 'outside_photo', 'crown_unclear']

/** A warning of the service, and the stroke that it is about. */
export interface StrokeRemark {
  readonly warning: StrokeWarning
  readonly stroke: StrokeRef | null
}

/** List what the service remarked on the strokes as they stand. */
export function remarksOn({ traced, history }: Pick<State, 'traced' | 'history'>): StrokeRemark[] {
  if (traced?.of !== history.present) return []
  return traced.answer.warnings.map(warning => ({ warning, stroke: strokeAt(`/${warning.stroke}`) }))
}

/** Find the first remark that doubts that a stroke means a tree; it stands until the stroke is drawn anew. */
export function doubtIn(state: State): StrokeRemark | null {
  return remarksOn(state).find(({ warning }) => DOUBTS.includes(warning.code)) ?? null
}
