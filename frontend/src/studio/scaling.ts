import { distance } from '../plane'
import { drawnOn } from '../sheets'
import type { State } from '../state'
import type { Line } from '../strokes'

/** Return a guess of a line's length over the photo, at least 0.01 metres. */
export function metresOf([from, to]: Line, state: State): number {
  if (!from || !to) return 1
  const metres = distance(from, to) * metresPerPixel(state)
  return Math.max(Number(metres.toPrecision(2)), 0.01)
}

/** Return metres per px, by the measured line, else by the height setting and the strokes' height; 0 without strokes. */
function metresPerPixel(state: State): number {
  const { scale, crown, branches } = drawnOn(state, 'front')
  if (scale) return scale.metres / Math.max(distance(scale.points[0]!, scale.points[1]!), 1)
  const trunk = branches[0]?.points ?? []
  const heights = [...(crown ?? []), ...trunk].map(([, y]) => y)
  const pixels = Math.max(...heights) - Math.min(...heights)
  return pixels > 0 && Number.isFinite(pixels) ? state.settings.height / pixels : 0
}
