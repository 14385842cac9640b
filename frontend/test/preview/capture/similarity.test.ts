import { expect, test } from 'vitest'
import { after, inverse, moved, placing, scaleOf, scaling, turned } from '../../../src/preview/capture/similarity'

const QUARTER = placing([1, 2, 3], [10, 0, 0], { turn: Math.PI / 2, scale: 2 })

function close(point: readonly number[], expected: readonly number[]): void {
  expected.forEach((value, at) => {
    expect(point[at]).toBeCloseTo(value, 9)
  })
}

test('placing moves its point where it should, turns about the vertical and scales', () => {
  close(moved(QUARTER, [1, 2, 3]), [10, 0, 0])
  close(moved(QUARTER, [1, 2, 4]), [12, 0, 0])
  close(turned(QUARTER, [0, 0, 1]), [1, 0, 0])
  expect(scaleOf(QUARTER)).toBeCloseTo(2, 12)
})

test('the inverse leads back', () => {
  close(moved(inverse(QUARTER), moved(QUARTER, [-4, 5, 0.5])), [-4, 5, 0.5])
})

test('one after the other is the same as both in turn', () => {
  close(moved(after(scaling(3), QUARTER), [4, 4, 4]), moved(scaling(3), moved(QUARTER, [4, 4, 4])))
})
