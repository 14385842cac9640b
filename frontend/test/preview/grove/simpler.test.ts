import { BufferAttribute, BufferGeometry } from 'three'
import { expect, test } from 'vitest'
import { fewerCards, thickWood } from '../../../src/preview/grove/simpler'

/** Square cards in a row, each one unit wide. */
function cards(count: number): BufferGeometry {
  const corners = Array.from({ length: count }, (_, at) => [at, 0, 0, at + 1, 0, 0, at + 1, 1, 0, at, 1, 0])
  const index = Array.from({ length: count }, (_, at) => [0, 1, 2, 0, 2, 3].map(corner => corner + 4 * at))
  const geometry = new BufferGeometry().setIndex(index.flat())
  return geometry.setAttribute('position', new BufferAttribute(Float32Array.from(corners.flat()), 3))
}

test('few cards cover about as much as all of them', () => {
  const few = fewerCards(cards(60))
  expect(few.index!.count / 6).toBe(10)
  const position = few.getAttribute('position')
  const width = position.getX(1) - position.getX(0)
  expect(width ** 2 * 10).toBeGreaterThan(0.75 * 60)
  expect(width ** 2 * 10).toBeLessThan(1.25 * 60)
  expect((position.getX(0) + position.getX(1)) / 2).toBeCloseTo(0.5, 5)
})

test('of wood the largest triangles stay', () => {
  const sizes = [1, 9, 2, 8, 3, 7, 4, 6, 5, 10]
  const corners = sizes.flatMap(size => [0, 0, 0, size, 0, 0, 0, size, 0])
  const wood = new BufferGeometry().setIndex(Array.from({ length: 30 }, (_, at) => at))
  wood.setAttribute('position', new BufferAttribute(Float32Array.from(corners), 3))
  const kept = thickWood(wood).index!
  const sizesKept = Array.from({ length: kept.count / 3 }, (_, at) => sizes[Math.floor(kept.getX(at * 3) / 3)]!)
  expect(sizesKept.sort((one, other) => other - one)).toEqual([10, 9, 8])
})
