import { expect, test } from 'vitest'
import type { TracedSkeleton } from '../src/api/types'
import { distance, intersect, type Segment } from '../src/plane'
import { branchAt, continuationsOf, eraseLine, firstJoint, segmentTo } from '../src/tracedBranch'
import { TREE } from './sketch/tree'

const traced = (skeleton: TracedSkeleton) => [...skeleton.points.keys()].filter(joint => skeleton.stroke[joint]! < 0)

/** A traced bush on a short trunk: each joint has up to three children at narrow angles. */
function bush(count: number): TracedSkeleton {
  const points: [number, number][] = [
    [0, 1000],
    [0, 900],
  ]
  const parents = [-1, 0]
  for (let joint = 2; joint < count; joint++) {
    const parent = Math.max(1, Math.floor((joint - 2) / 3) + 1)
    const [x, y] = points[parent]!
    const turn = -Math.PI / 2 + ((joint % 3) - 1) * 0.5 + 0.9 * Math.sin(joint * 12.9898)
    points.push([x + (9 + (joint % 7)) * Math.cos(turn), y + (9 + (joint % 7)) * Math.sin(turn)])
    parents.push(parent)
  }
  const stroke = parents.map((_, joint) => (joint < 2 ? 0 : -1))
  return { points, parents, stroke, radii: parents.map((_, joint) => 50 / (joint + 5)) }
}

test('a branch begins after its fork from a stroke or from a thicker branch', () => {
  expect(traced(TREE).map(joint => firstJoint(TREE, joint))).toEqual([3, 3, 3, 6, 6, 8])
})

test('the thickest child continues a branch, and of equally thick ones the longest', () => {
  expect(continuationsOf(TREE)).toEqual([false, true, true, false, true, true, false, true, false])
  const even = { ...TREE, radii: TREE.radii.map(() => 2) }
  expect(firstJoint(even, 7)).toBe(3)
  expect(firstJoint(even, 5)).toBe(5)
})

test('a branch includes all branches that leave it and nothing else', () => {
  expect(branchAt(TREE, 5)).toEqual([3, 4, 5, 6, 7])
  expect(branchAt(TREE, 7)).toEqual([6, 7])
  expect(branchAt(TREE, 8)).toEqual([8])
})

test.each([
  { name: 'a small tree', skeleton: TREE },
  { name: 'a dense bush', skeleton: bush(120) },
])('in $name an erase stroke crosses the segment to its joint and no other', ({ skeleton }) => {
  const pieces = [...skeleton.points.keys()].map(joint => segmentTo(skeleton, joint))
  for (const joint of traced(skeleton)) {
    const own = pieces[joint]!
    // Where two branches lie on each other no line can tell them apart.
    if (pieces.some((piece, other) => other !== joint && crossesInside(own, piece))) continue
    const line = eraseLine(skeleton, joint) as unknown as Segment
    expect(pieces.flatMap((piece, other) => (intersect(line, piece) ? [other] : []))).toEqual([joint])
    expect(distance(...line)).toBeGreaterThan(0.01)
    const [dx, dy, ex, ey] = [
      line[1][0] - line[0][0],
      line[1][1] - line[0][1],
      own[1][0] - own[0][0],
      own[1][1] - own[0][1],
    ]
    expect(Math.abs(dx * ex + dy * ey)).toBeLessThan(1e-9 * distance(...line) * distance(...own) + 1e-9)
  }
})

test('an erase stroke lies within the first step, so that no stump is left', () => {
  const long = { ...TREE, points: TREE.points.with(5, [340, 150]) }
  for (const joint of [4, 5, 6, 7]) {
    const [from, to] = eraseLine(long, joint)
    const middle = [(from![0] + to![0]) / 2, (from![1] + to![1]) / 2] as const
    expect(distance(middle, segmentTo(long, joint)[0])).toBeLessThan(distance(...segmentTo(long, 3)))
  }
})

function crossesInside(one: Segment, other: Segment): boolean {
  const touch = one.some(end => other.some(place => distance(end, place) < 1e-9))
  return !touch && intersect(one, other)
}
