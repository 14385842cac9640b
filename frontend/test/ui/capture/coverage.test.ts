import { expect, test } from 'vitest'
import { IDENTITY } from '../../../src/preview/capture/similarity'
import { text } from '../../../src/text'
import { directionOf, gapsIn, missingDirections, planOf } from '../../../src/ui/capture/coverage'
import { ringOf } from '../../preview/capture/cameras'

const DEGREE = Math.PI / 180
const plan = (...degrees: number[]) =>
  degrees.map(degree => ({ photo: `${degree}.jpg`, azimuth: degree * DEGREE, distance: 1 }))
const every = (step: number, to = 360) => plan(...Array.from({ length: to / step }, (_, at) => at * step))

test('photos lie where they were taken, the front at 0 and the right side a quarter further', () => {
  const ring = planOf(ringOf(4), IDENTITY)
  expect(ring.map(({ azimuth }) => Math.round(azimuth / DEGREE))).toEqual([0, 90, expect.closeTo(180, 0), -90])
  expect(ring.every(({ distance }) => Math.abs(distance - 1) < 1e-9)).toBe(true)
})

test('a ring of photos every 20 degrees has no gap, one every 40 degrees has one after each', () => {
  expect(gapsIn(every(20))).toEqual([])
  expect(gapsIn(every(40))).toHaveLength(9)
})

test('half a circle leaves the other half, and a sentence says which', () => {
  const gaps = gapsIn(plan(-90, -60, -30, 0, 30, 60, 90).map(place => ({ ...place, azimuth: place.azimuth * 0.99 })))
  expect(gaps).toHaveLength(1)
  expect((gaps[0]!.to - gaps[0]!.from) / DEGREE).toBeCloseTo(181.8, 6)
  expect(text.measured.coverage.missing(missingDirections(gaps))).toBe('More photos would help from behind.')
})

test('the widest gaps are named first, each direction once', () => {
  const gaps = gapsIn(plan(0, 20, 40, 60, 80, 160, 180, 200, 220, 270, 290, 310, 330, 350))
  expect(missingDirections(gaps)).toEqual([3, 5])
  expect(text.measured.coverage.missing([3, 5])).toBe(
    'More photos would help from behind, to the right; and from behind, to the left.',
  )
})

test('a lone photo leaves all other sides', () => {
  expect(missingDirections(gapsIn(plan(0)))).toEqual([4])
})

test('directions are eighths of a turn to the right', () => {
  expect([0, 44, 91, -91, 181, 359].map(degree => directionOf(degree * DEGREE))).toEqual([0, 1, 2, 6, 4, 0])
})
