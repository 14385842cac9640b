import { expect, it } from 'vitest'
import { gainOf } from '../../src/preview/model'

it('brings dark textures up, halfway at most, and leaves bright ones alone', () => {
  expect(gainOf(0.4)).toBe(1)
  expect(gainOf(0.05)).toBeCloseTo(2, 6)
  expect(gainOf(0)).toBe(4)
})
