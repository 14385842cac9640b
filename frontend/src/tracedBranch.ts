import type { TracedSkeleton } from './api/types'
import { along, cross, distance, distanceToPiece, type Piece } from './plane'
import type { Line, Point } from './strokes'

/** Places where a branch's first step may be cut, as shares of the step. */
const CUTS = [0.5, 0.6, 0.4, 0.7, 0.3, 0.8, 0.9]
/** Of the way to the nearest other branch: as far again to either, since the service cuts a less simplified line. */
const REACH = 0.5

const continuations = new WeakMap<TracedSkeleton, readonly boolean[]>()

/** Tell which joints carry their parent's branch on; the others begin a branch of their own. */
export function continues(skeleton: TracedSkeleton): readonly boolean[] {
  const known = continuations.get(skeleton)
  if (known) return known
  const found = findContinuations(skeleton)
  continuations.set(skeleton, found)
  return found
}

/** The first joint of the traced branch (stroke -1) that a joint lies on: the one after the fork that it leaves from. */
export function firstJoint(skeleton: TracedSkeleton, joint: number): number {
  const further = continues(skeleton)
  let first = joint
  while (further[first]) first = skeleton.parents[first]!
  return first
}

/** The joints of the traced branch that a joint lies on, its first one first, with all that it bears. */
export function branchAt(skeleton: TracedSkeleton, joint: number): number[] {
  const first = firstJoint(skeleton, joint)
  const borne = new Set([first])
  for (let next = first + 1; next < skeleton.parents.length; next++) {
    if (borne.has(skeleton.parents[next]!)) borne.add(next)
  }
  return [...borne]
}

/** The piece from a joint's parent to the joint; a root's is the root alone. */
export function pieceTo({ points, parents }: TracedSkeleton, joint: number): Piece {
  const end = points[joint]!
  return [points[parents[joint]!] ?? end, end]
}

/** A short line across the piece from a joint's parent to the joint and across no other: `erase` drops what it crosses. */
export function eraseLine(skeleton: TracedSkeleton, joint: number): Line {
  const piece = pieceTo(skeleton, joint)
  const pieces = [...skeleton.points.keys()].filter(other => other !== joint).map(other => pieceTo(skeleton, other))
  const room = (place: Point) => Math.min(distance(...piece), ...pieces.map(other => distanceToPiece(other, place)))
  const step = stepFrom(skeleton, joint)
  const places = CUTS.map(share => along(piece, share * step)).toSorted((one, other) => room(other) - room(one))
  return shrunk(places[0]!, piece, REACH * room(places[0]!), pieces)
}

/**
 * The share of a joint's piece that was one step before the service simplified the line. Steps are alike, and the first
 * that leaves a stroke is left as it was; a cut further out would leave a stump of some steps.
 */
function stepFrom(skeleton: TracedSkeleton, joint: number): number {
  const { parents, stroke } = skeleton
  let root = joint
  while (stroke[parents[root]!] === -1) root = parents[root]!
  return Math.min(distance(...pieceTo(skeleton, root)) / distance(...pieceTo(skeleton, joint)), 1) || 1
}

function shrunk(middle: Point, piece: Piece, reach: number, others: readonly Piece[]): Line {
  const line = across(middle, piece, reach)
  return reach > 1e-3 && others.some(other => cross(line, other)) ? shrunk(middle, piece, reach / 2, others) : line
}

function across([x, y]: Point, [from, to]: Piece, reach: number): Piece {
  const length = distance(from, to) || 1
  const [right, down] = [(-(to[1] - from[1]) / length) * reach, ((to[0] - from[0]) / length) * reach]
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

/** The longest way from each joint's parent outward through the joint. */
function lengthsBeyond(skeleton: TracedSkeleton): number[] {
  const { parents } = skeleton
  const lengths = parents.map((_, joint) => distance(...pieceTo(skeleton, joint)))
  const beyond = [...lengths]
  for (let joint = parents.length - 1; joint > 0; joint--) {
    const parent = parents[joint]!
    if (parent >= 0) beyond[parent] = Math.max(beyond[parent]!, lengths[parent]! + beyond[joint]!)
  }
  return beyond
}
