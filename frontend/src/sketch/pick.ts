import type { TracedSkeleton } from '../api/types'
import { along, distance, distanceToLine, nearestShare } from '../plane'
import type { Selection } from '../state'
import { lineOf, type Point, type StrokeRef, type Strokes, strokeRefs } from '../strokes'
import { firstJoint, segmentTo } from '../tracedBranch'

/** Return what lies within `tolerance` sheet px of a point: the nearest stroke, else the nearest traced branch. */
export function pick(
  strokes: Strokes,
  skeleton: TracedSkeleton | null,
  at: Point,
  tolerance: number,
): Selection | null {
  return pickStroke(strokes, at, tolerance) ?? (skeleton && pickTraced(strokes, skeleton, at, tolerance))
}

/** Return the other end of the measured line where one end lies within `tolerance` sheet px of a point; else null. */
export function otherEnd({ scale }: Strokes, at: Point, tolerance: number): Point | null {
  const [from, to] = scale?.points ?? []
  if (!from || !to || Math.min(distance(from, at), distance(to, at)) > tolerance) return null
  return distance(from, at) < distance(to, at) ? to : from
}

function pickStroke(strokes: Strokes, at: Point, tolerance: number): StrokeRef | null {
  let [nearest, least]: [StrokeRef | null, number] = [null, tolerance]
  for (const ref of strokeRefs(strokes)) {
    const brush = ref.kind === 'branch' ? (strokes.branches[ref.index]?.width ?? 0) : 0
    const gap = distanceToLine(lineOf(strokes, ref), at, ref.kind === 'crown') - brush / 2
    if (gap <= least) [nearest, least] = [ref, gap]
  }
  return nearest
}

function pickTraced(strokes: Strokes, skeleton: TracedSkeleton, at: Point, tolerance: number): Selection | null {
  let [nearest, least] = [-1, tolerance]
  for (const joint of skeleton.points.keys()) {
    const gap = distanceToWood(skeleton, joint, at)
    if (gap < least) [nearest, least] = [joint, gap]
  }
  if (nearest < 0) return null
  const index = skeleton.stroke[nearest]!
  if (index < 0) return { kind: 'traced', joint: firstJoint(skeleton, nearest) }
  return index < strokes.branches.length ? { kind: 'branch', index } : null
}

/** Return how far a point lies outside the wood between a joint and its parent, sheet px; negative inside. */
function distanceToWood(skeleton: TracedSkeleton, joint: number, at: Point): number {
  const segment = segmentTo(skeleton, joint)
  return distance(along(segment, nearestShare(segment, at)), at) - skeleton.radii[joint]!
}
