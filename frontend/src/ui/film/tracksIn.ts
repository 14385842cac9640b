import type { Tracks } from '../../api/types'
import type { State } from '../../state'

/** Return the points that were followed through the open clip; null before. */
export function tracksIn({ traced, sheets }: Pick<State, 'traced' | 'sheets'>): Tracks | null {
  const answer = traced?.answer
  return sheets?.source === 'clip' && answer && 'tracks' in answer ? answer.tracks : null
}
