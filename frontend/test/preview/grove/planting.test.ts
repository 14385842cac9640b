import { expect, test } from 'vitest'
import { plant } from '../../../src/preview/grove/planting'

const RADII = [2, 5, 3]

test('a grove has as many trees as asked for, of all kinds in turn', () => {
  const trees = plant(31, RADII, 1)
  expect(trees).toHaveLength(31)
  expect(RADII.map((_, kind) => trees.filter(tree => tree.kind === kind).length)).toEqual([11, 10, 10])
})

test('crowns hardly overlap, and the grove is no larger than it must be', () => {
  const trees = plant(60, RADII, 1)
  for (const [at, one] of trees.entries())
    for (const other of trees.slice(at + 1)) {
      const apart = Math.hypot(one.x - other.x, one.z - other.z)
      expect(apart).toBeGreaterThan(0.9 * (RADII[one.kind]! * one.size + RADII[other.kind]! * other.size))
    }
  const reach = Math.max(...trees.map(({ x, z }) => Math.hypot(x, z)))
  expect(reach).toBeLessThan(60)
})

test('the same seed plants the same grove, another one another', () => {
  expect(plant(20, RADII, 1)).toEqual(plant(20, RADII, 1))
  expect(plant(20, RADII, 2)).not.toEqual(plant(20, RADII, 1))
})
