import { expect, test } from 'vitest'
import { PenLine } from '../../src/sketch/penLine'
import type { Point } from '../../src/strokes'

const SHEET = { width: 1200, height: 1541 }

function drawn(kind: 'crown' | 'branch', points: readonly Point[], spacing = 0) {
  const pen = new PenLine(kind, SHEET)
  for (const point of points) pen.add(point, spacing)
  return pen
}

test('points are rounded to hundredths of a pixel', () => {
  expect(
    drawn('branch', [
      [0.126, 7],
      [8.4449, 1000.994],
    ]).finished(),
  ).toEqual([
    [0.13, 7],
    [8.44, 1000.99],
  ])
})

test('a stroke never leaves the sheet', () => {
  expect(
    drawn('branch', [
      [-50, 20],
      [1300, 1700],
    ]).finished(),
  ).toEqual([
    [0, 20],
    [1200, 1541],
  ])
})

test('points too near to the last one are left out', () => {
  expect(
    drawn(
      'branch',
      [
        [0, 0],
        [0.5, 0],
        [0.9, 0],
        [1.1, 0],
        [1.9, 0],
      ],
      1,
    ).points,
  ).toEqual([
    [0, 0],
    [1.1, 0],
  ])
})

test('a branch has two distinct points and a crown three', () => {
  expect(
    drawn('branch', [
      [5, 5],
      [5, 5],
    ]).finished(),
  ).toBeNull()
  expect(
    drawn('branch', [
      [5, 5],
      [6, 5],
    ]).finished(),
  ).toHaveLength(2)
  expect(
    drawn('crown', [
      [5, 5],
      [9, 9],
      [5, 5],
    ]).finished(),
  ).toBeNull()
  expect(
    drawn('crown', [
      [5, 5],
      [9, 9],
      [5, 9],
    ]).finished(),
  ).toHaveLength(3)
})

test('a stroke outside the sheet is only what lies on its edge, here one point', () => {
  expect(
    drawn('branch', [
      [-5, 7],
      [-50, 7],
      [-90, 7],
    ]).finished(),
  ).toBeNull()
})

test('an endless stroke is thinned, from its start to its end, and never has more than 10,000 points', () => {
  const points = Array.from({ length: 70_000 }, (_, step): Point => [600 + 400 * Math.cos(step / 9), step / 50])
  const line = drawn('branch', points).finished()!
  expect(line.length).toBeLessThanOrEqual(10_000)
  expect(line.length).toBeGreaterThan(4000)
  expect(line[0]).toEqual([1000, 0])
  expect(line.at(-1)![1]).toBeGreaterThan(1390)
})

test('a measured line is straight, from its first point to its last', () => {
  const pen = new PenLine('scale', SHEET)
  const points: Point[] = [
    [10, 10],
    [20, 12],
    [30, 90],
  ]
  for (const point of points) pen.add(point, 0)
  expect(pen.finished()).toEqual([points[0], points[2]])
})

test('a measured line whose one end is moved keeps its other end exactly', () => {
  const other: Point = [5, 5]
  const pen = new PenLine('scale', SHEET, other)
  pen.add([50, 60], 0)
  pen.add([70, 80], 0)
  expect(pen.finished()).toEqual([other, [70, 80]])
  expect(pen.finished()![0]).toBe(other)
})
