import { expect, test } from 'vitest'
import { distanceToLine } from '../../src/plane'
import { otherEnd, pick } from '../../src/sketch/pick'
import type { Strokes } from '../../src/strokes'
import { TREE } from './tree'

const STROKES: Strokes = {
  crown: [
    [20, 20],
    [180, 20],
    [180, 160],
    [20, 160],
  ],
  branches: [
    {
      points: [
        [100, 200],
        [100, 100],
      ],
    },
  ],
  erase: [
    [
      [60, 60],
      [70, 60],
    ],
  ],
  scale: null,
}
const NONE: Strokes = { crown: null, branches: [], erase: [], scale: null }

test('the nearest stroke within reach is picked', () => {
  expect(pick(STROKES, null, [103, 190], 10)).toEqual({ kind: 'branch', index: 0 })
  expect(pick(STROKES, null, [178, 100], 10)).toEqual({ kind: 'crown', index: 0 })
  expect(pick(STROKES, null, [65, 63], 10)).toEqual({ kind: 'erase', index: 0 })
  expect(pick(STROKES, null, [140, 80], 10)).toBeNull()
})

test('a crown can be picked where it is closed', () => {
  expect(pick(STROKES, null, [22, 90], 5)).toEqual({ kind: 'crown', index: 0 })
})

test('a stroke is picked before a traced branch that lies nearer', () => {
  expect(pick(STROKES, TREE, [107, 149], 10)).toEqual({ kind: 'branch', index: 0 })
})

test('a traced branch is picked by its first joint', () => {
  expect(pick(STROKES, TREE, [168, 149], 10)).toEqual({ kind: 'traced', joint: 3 })
  expect(pick(STROKES, TREE, [151, 80], 10)).toEqual({ kind: 'traced', joint: 6 })
})

test('wood traced along a stroke picks that stroke, also beside its line', () => {
  const { branches } = STROKES
  expect(pick({ ...NONE, branches }, TREE, [92, 170], 3)).toEqual({ kind: 'branch', index: 0 })
  expect(pick(NONE, TREE, [92, 170], 3)).toBeNull()
})

test('where nothing was drawn or traced nothing is picked', () => {
  expect(pick(NONE, null, [5, 5], 1000)).toBeNull()
  expect(distanceToLine([], [0, 0])).toBe(Number.POSITIVE_INFINITY)
})

test('a measured line is picked, and near each end its other end is found', () => {
  const scale = {
    points: [
      [10, 10],
      [10, 60],
    ] as const,
    metres: 2,
  }
  expect(pick({ ...NONE, scale }, null, [12, 30], 5)).toEqual({ kind: 'scale', index: 0 })
  expect(otherEnd({ ...NONE, scale }, [11, 58], 5)).toBe(scale.points[0])
  expect(otherEnd({ ...NONE, scale }, [11, 12], 5)).toBe(scale.points[1])
  expect(otherEnd({ ...NONE, scale }, [11, 30], 5)).toBeNull()
  expect(otherEnd(NONE, [11, 30], 5)).toBeNull()
})
