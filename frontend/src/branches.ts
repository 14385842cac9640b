import type { Edit, Spot } from './edits'

/** Visible branches in a capture's frame; `seen` is false where a joint only joins others, or was added by hand. */
export interface Branches {
  readonly points: readonly Spot[]
  readonly radii: readonly number[]
  /** The joint that each one hangs on, before it in the list; -1 at the root, joint 0. */
  readonly parents: readonly number[]
  readonly seen: readonly boolean[]
}

/** Where one steps from a joint: to the one that it hangs on, to that which bears most, or to another at its fork. */
export type Step = 'inward' | 'outward' | 'across'

/** The radius at the start of a branch that is added, as a share of its parent's, and at its tip, as a share of that. */
const OF_PARENT = 0.6
const OF_START = 0.25

/**
 * Return branches about as the service will answer them with one more edit, to be shown until it does. A piece that is
 * joined stays where it is until then.
 */
export function applied(branches: Branches, edit: Edit): Branches {
  if (edit.do === 'add') return added(branches, nearestJoint(branches, edit.from), edit)
  const joint = nearestJoint(branches, edit.at)
  if (edit.do === 'remove') return without(branches, joint)
  if (edit.do === 'move') return moved(branches, joint, edit.to)
  return edit.do === 'radius' ? thickened(branches, joint, edit.radius) : branches
}

/** Return the joint that is nearest to a place; -1 where there is none. */
export function nearestJoint({ points }: Branches, place: Spot): number {
  let [nearest, least] = [-1, Number.POSITIVE_INFINITY]
  for (const [joint, point] of points.entries()) {
    const away = Math.hypot(point[0] - place[0], point[1] - place[1], point[2] - place[2])
    if (away < least) [nearest, least] = [joint, away]
  }
  return nearest
}

/** Return for each joint whether it is this one or leaves it. */
export function beyond({ parents }: Pick<Branches, 'parents'>, joint: number): boolean[] {
  const marked: boolean[] = []
  for (const [at, parent] of parents.entries()) marked.push(at === joint || (marked[parent] ?? false))
  return marked
}

/** Return branches with a joint elsewhere, and what is beyond it; the way to it from the last fork bends along. */
export function moved(branches: Branches, joint: number, to: Spot): Branches {
  const from = branches.points[joint]
  if (!from || joint === 0) return branches
  const shares = sharesOf(branches, joint)
  const points = branches.points.map((point, at): Spot => {
    const share = shares[at]!
    const on = (axis: 0 | 1 | 2) => point[axis] + share * (to[axis] - from[axis])
    return share ? [on(0), on(1), on(2)] : point
  })
  return { ...branches, points }
}

function thickened(branches: Branches, joint: number, radius: number): Branches {
  const factor = radius / Math.max(branches.radii[joint] ?? 0, 1e-12)
  const shares = sharesOf(branches, joint)
  return { ...branches, radii: branches.radii.map((own, at) => own * (1 + shares[at]! * (factor - 1))) }
}

/** Return how much each joint follows an edit of one: it and those beyond 1, from the last fork to it 0 to 1, others 0. */
function sharesOf(branches: Branches, joint: number): number[] {
  const { points, parents } = branches
  const children = parents.map(() => 0)
  for (const parent of parents) if (parent >= 0) children[parent]!++
  const lengthTo = (at: number) => distance(points[at]!, points[parents[at]!] ?? points[at]!)
  const way = [joint]
  for (let at = parents[joint]!; at > 0 && children[at] === 1; at = parents[at]!) way.unshift(at)
  const whole = way.reduce((sum, at) => sum + lengthTo(at), 0)
  const shares = beyond(branches, joint).map(Number)
  let far = 0
  for (const at of way) {
    far += lengthTo(at)
    shares[at] = at === joint ? 1 : far / Math.max(whole, 1e-12)
  }
  return shares
}

function without(branches: Branches, joint: number): Branches {
  if (joint <= 0) return branches
  const gone = beyond(branches, joint)
  const kept = [...gone.keys()].filter(at => !gone[at])
  const number = new Map(kept.map((at, place) => [at, place]))
  const of = <T>(values: readonly T[]) => kept.map(at => values[at]!)
  const parents = kept.map(at => number.get(branches.parents[at]!) ?? -1)
  return { points: of(branches.points), radii: of(branches.radii), parents, seen: of(branches.seen) }
}

function added(branches: Branches, parent: number, { points, radius }: Edit & { do: 'add' }): Branches {
  if (parent < 0) return branches
  const count = branches.points.length
  const start = radius ?? OF_PARENT * branches.radii[parent]!
  const taper = points.map((_, at) => start * (1 - ((1 - OF_START) * (at + 1)) / points.length))
  return {
    points: [...branches.points, ...points],
    radii: [...branches.radii, ...taper],
    parents: [...branches.parents, ...points.map((_, at) => (at ? count + at - 1 : parent))],
    seen: [...branches.seen, ...points.map(() => false)],
  }
}

/** Return the joint one step from another, the first one after the root where there is none yet; the same where it ends. */
export function stepped({ parents }: Pick<Branches, 'parents'>, joint: number | null, step: Step): number {
  if (joint === null) return Math.min(1, parents.length - 1)
  if (step === 'inward') return Math.max(parents[joint]!, 0)
  if (step === 'across') return siblingAtFork(parents, joint)
  const borne = borneBy(parents)
  const [first, ...others] = childrenOf(parents, joint)
  return others.reduce((best, child) => (borne[child]! > borne[best]! ? child : best), first ?? joint)
}

/** Return how many joints each one bears, itself among them. Radii tell less: along a trunk they may all be the same. */
function borneBy(parents: readonly number[]): number[] {
  const borne = parents.map(() => 1)
  for (let joint = parents.length - 1; joint > 0; joint--)
    if (parents[joint]! >= 0) borne[parents[joint]!]! += borne[joint]!
  return borne
}

/** Return the next of those that leave the last fork before a joint, after the one that leads to it. */
function siblingAtFork(parents: readonly number[], joint: number): number {
  for (let at = joint; parents[at]! >= 0; at = parents[at]!) {
    const siblings = childrenOf(parents, parents[at]!)
    if (siblings.length > 1) return siblings[(siblings.indexOf(at) + 1) % siblings.length]!
  }
  return joint
}

function childrenOf(parents: readonly number[], joint: number): number[] {
  return [...parents.keys()].filter(at => parents[at] === joint)
}

function distance(one: Spot, other: Spot): number {
  return Math.hypot(one[0] - other[0], one[1] - other[1], one[2] - other[2])
}
