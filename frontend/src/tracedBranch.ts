import type { TracedSkeleton } from './api/types'
import { along, distance, distanceToSegment, intersect, type Segment } from './plane'
import type { Line, Point } from './strokes'

/** Where a branch's first step may be cut, as shares of the step; of equally free places the first is used. */
const CUTS = [0.5, 0.6, 0.4, 0.7, 0.3, 0.8, 0.9]
/** Half an erase stroke's length, as a share of the distance to the nearest other branch; the service's lines differ a bit. */
const HALF_LENGTH = 0.5

const continuations = new WeakMap<TracedSkeleton, readonly boolean[]>()

/** Return which joints continue their parent's branch; the others begin a new one. */
export function continuationsOf(skeleton: TracedSkeleton): readonly boolean[] {
  const cached = continuations.get(skeleton)
  if (cached) return cached
  const found = findContinuations(skeleton)
  continuations.set(skeleton, found)
  return found
}

/** Return the first joint of a joint's traced branch (stroke -1): the one after the fork where the branch starts. */
export function firstJoint(skeleton: TracedSkeleton, joint: number): number {
  const continued = continuationsOf(skeleton)
  let first = joint
  while (continued[first]) first = skeleton.parents[first]!
  return first
}

/** Return the joints of a joint's traced branch, the first one first, with those of all branches that leave it. */
export function branchAt(skeleton: TracedSkeleton, joint: number): number[] {
  const first = firstJoint(skeleton, joint)
  const joints = new Set([first])
  for (let next = first + 1; next < skeleton.parents.length; next++) {
    if (joints.has(skeleton.parents[next]!)) joints.add(next)
  }
  return [...joints]
}

/** Return the segment from a joint's parent to the joint; a root's has no length. */
export function segmentTo({ points, parents }: TracedSkeleton, joint: number): Segment {
  const end = points[joint]!
  return [points[parents[joint]!] ?? end, end]
}

/** Return an erase stroke that removes a joint's branch: a short line across the joint's segment and no other. */
export function eraseLine(skeleton: TracedSkeleton, joint: number): Line {
  const segment = segmentTo(skeleton, joint)
  const segments = [...skeleton.points.keys()].filter(other => other !== joint).map(other => segmentTo(skeleton, other))
  const room = (point: Point) =>
    Math.min(distance(...segment), ...segments.map(other => distanceToSegment(other, point)))
  const step = firstStep(skeleton, joint)
  const [cut] = CUTS.map(share => along(segment, share * step)).toSorted((one, other) => room(other) - room(one))
  return shrunk(cut!, segment, HALF_LENGTH * room(cut!), segments)
}

/**
 * Return which share of a joint's segment was its first step before the service simplified the line; a cut beyond it would
 * leave a stump. Steps are about equally long, and the first one from a stroke is never simplified.
 */
function firstStep(skeleton: TracedSkeleton, joint: number): number {
  const { parents, stroke } = skeleton
  let root = joint
  while (stroke[parents[root]!] === -1) root = parents[root]!
  return Math.min(distance(...segmentTo(skeleton, root)) / distance(...segmentTo(skeleton, joint)), 1) || 1
}

/** Return a line across a segment, `halfLength` to either side, halved until it crosses no other segment. */
function shrunk(middle: Point, segment: Segment, halfLength: number, others: readonly Segment[]): Line {
  const line = across(middle, segment, halfLength)
  return halfLength > 1e-3 && others.some(other => intersect(line, other))
    ? shrunk(middle, segment, halfLength / 2, others)
    : line
}

function across([x, y]: Point, [from, to]: Segment, halfLength: number): Segment {
  const length = distance(from, to) || 1
  const [right, down] = [(-(to[1] - from[1]) / length) * halfLength, ((to[0] - from[0]) / length) * halfLength]
  return [
    [x - right, y - down],
    [x + right, y + down],
  ]
}

function findContinuations(skeleton: TracedSkeleton): boolean[] {
  const { parents, stroke, radii } = skeleton
  const length = lengthsBeyond(skeleton)
  const best = new Map<number, number>()
  for (const [joint, parent] of parents.entries()) {
    if (parent < 0 || stroke[joint] !== stroke[parent]) continue
    const rival = best.get(parent)
    const thicker = rival === undefined ? 1 : radii[joint]! - radii[rival]! || length[joint]! - length[rival]!
    if (thicker > 0) best.set(parent, joint)
  }
  return parents.map((parent, joint) => best.get(parent) === joint)
}

/** Return the longest path from each joint's parent outward through the joint. */
function lengthsBeyond(skeleton: TracedSkeleton): number[] {
  const { parents } = skeleton
  const lengths = parents.map((_, joint) => distance(...segmentTo(skeleton, joint)))
  const beyond = [...lengths]
  for (let joint = parents.length - 1; joint > 0; joint--) {
    const parent = parents[joint]!
    if (parent >= 0) beyond[parent] = Math.max(beyond[parent]!, lengths[parent]! + beyond[joint]!)
  }
  return beyond
}
