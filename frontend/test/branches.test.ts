import { expect, test } from 'vitest'
import { applied, type Branches, beyond, nearestJoint, stepped } from '../src/branches'

/** A trunk of four joints, with a limb of two that leaves its second one. */
const TREE: Branches = {
  points: [
    [0, 0, 0],
    [0, 1, 0],
    [0, 2, 0],
    [0, 3, 0],
    [1, 1, 0],
    [2, 1, 0],
  ],
  radii: [0.4, 0.3, 0.2, 0.1, 0.1, 0.05],
  parents: [-1, 0, 1, 2, 1, 4],
  seen: [true, true, true, true, false, true],
}

test('a joint is found by the place nearest to it, and what leaves it by its parents', () => {
  expect(nearestJoint(TREE, [1.2, 0.9, 0])).toBe(4)
  expect(beyond(TREE, 2)).toEqual([false, false, true, true, false, false])
})

test('removing takes the branch from that joint on, and numbers the others anew', () => {
  const { points, parents, radii, seen } = applied(TREE, { do: 'remove', at: [0, 2, 0] })
  expect(points).toHaveLength(4)
  expect(parents).toEqual([-1, 0, 1, 2])
  expect([radii[2], seen[2]]).toEqual([0.1, false])
})

test('the root is neither removed nor moved', () => {
  expect(applied(TREE, { do: 'remove', at: [0, 0, 0] })).toBe(TREE)
  expect(applied(TREE, { do: 'move', at: [0, 0, 0], to: [1, 0, 0] })).toBe(TREE)
})

test('moving takes what is beyond along, and bends the way from the last fork', () => {
  const { points } = applied(TREE, { do: 'move', at: [2, 1, 0], to: [2, 1, 1] })
  expect(points[5]).toEqual([2, 1, 1])
  expect(points[4]).toEqual([1, 1, 0.5])
  expect(points.slice(0, 4)).toEqual(TREE.points.slice(0, 4))
  expect(applied(TREE, { do: 'move', at: [1, 1, 0], to: [1, 2, 0] }).points[5]).toEqual([2, 2, 0])
})

test('a radius scales those beyond, and those back to the fork less', () => {
  const { radii } = applied(TREE, { do: 'radius', at: [2, 1, 0], radius: 0.1 })
  expect(radii[5]).toBeCloseTo(0.1, 9)
  expect(radii[4]).toBeCloseTo(0.15, 9)
  expect(radii.slice(0, 4)).toEqual(TREE.radii.slice(0, 4))
})

test('a branch that is added tapers from a share of its parent’s radius', () => {
  const { points, parents, radii, seen } = applied(TREE, {
    do: 'add',
    from: [0, 2, 0],
    points: [
      [1, 2, 0],
      [2, 2, 0],
    ],
  })
  expect(points).toHaveLength(8)
  expect(parents.slice(6)).toEqual([2, 6])
  expect(seen.slice(6)).toEqual([false, false])
  expect([0.2, radii[6]!, radii[7]!]).toEqual([0.2, radii[6]!, radii[7]!].toSorted((one, other) => other - one))
})

test('a piece that is joined waits for the service’s answer', () => {
  expect(applied(TREE, { do: 'join', at: [2, 1, 0], to: [0, 3, 0] })).toBe(TREE)
})

test('steps lead along a branch, to what bears most, and to the others of a fork', () => {
  expect(stepped(TREE, null, 'outward')).toBe(1)
  expect(stepped(TREE, 1, 'outward')).toBe(2)
  expect(stepped(TREE, 3, 'outward')).toBe(3)
  expect(stepped(TREE, 5, 'inward')).toBe(4)
  expect(stepped(TREE, 5, 'across')).toBe(2)
  expect(stepped(TREE, 3, 'across')).toBe(4)
  expect(stepped(TREE, 0, 'inward')).toBe(0)
})
