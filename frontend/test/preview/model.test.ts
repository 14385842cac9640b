import { expect, it } from 'vitest'
import { gainOf } from '../../src/preview/model'

it('brightens dark textures halfway, four times at most, and keeps bright ones', () => {
  expect(gainOf(0.4)).toBe(1)
  expect(gainOf(0.05)).toBeCloseTo(2, 6)
  expect(gainOf(0)).toBe(4)
})
