import { expect, test } from 'vitest'
import { numberAt, numberIn, placeOf } from '../../../src/ui/parts/spans'

const HEIGHT = { min: 0.1, max: 150, whole: false }
const DENSITY = { min: 0, max: 3, whole: false }
const ROUNDS = { min: 0, max: 2000, whole: true }

test('a number is taken within its bounds, both included, and only a whole one where it must be', () => {
  expect(['0.1', '150', ' 12.5 '].map(written => numberIn(written, HEIGHT))).toEqual([0.1, 150, 12.5])
  expect(['', 'ten', '0.09', '150.1', 'NaN', '1e9'].map(written => numberIn(written, HEIGHT))).toEqual(
    Array(6).fill(null),
  )
  expect([numberIn('300', ROUNDS), numberIn('300.5', ROUNDS)]).toEqual([300, null])
})

test.each([HEIGHT, DENSITY, ROUNDS])('a slider reaches both ends and every place gives an allowed number: %o', span => {
  expect([numberAt(0, span), numberAt(1, span)]).toEqual([span.min, span.max])
  for (let place = 0; place <= 1; place += 0.01) expect(numberIn(String(numberAt(place, span)), span)).not.toBeNull()
})

test.each([
  [HEIGHT, 10],
  [HEIGHT, 2.5],
  [DENSITY, 1],
  [ROUNDS, 300],
])('a usual number lies where its place says: %o %d', (span, number) => {
  expect(numberAt(placeOf(number, span), span)).toBeCloseTo(number, 6)
})

test('small heights have as much room as large ones', () => {
  expect(placeOf(Math.sqrt(0.1 * 150), HEIGHT)).toBeCloseTo(0.5, 9)
})
