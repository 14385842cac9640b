import { expect, test } from 'vitest'
import { bytes, duration, hundredth, measured, metres, percent, seconds, typed, whole } from '../../src/text/numbers'

test('numbers are written as the language of the page has them', () => {
  expect([whole(16_237.4), hundredth(0.966), percent(0.922)]).toEqual(['16,237', '0.97', '92%'])
  expect([0.4213, 12.34, 1234.5].map(measured)).toEqual(['0.421', '12.3', '1,235'])
})

test('sizes, lengths and durations come with the unit that suits them', () => {
  expect([bytes(640_400), bytes(5_172_432), metres(1.8)]).toEqual(['640 kB', '5.2 MB', '1.8 m'])
  expect([duration(3.6), duration(200), seconds(1.75)]).toEqual(['4 sec', '3 min', '1.8 sec'])
})

test('a number for a field can be typed as it is written', () => {
  expect([0.1, 2000, Number.MAX_SAFE_INTEGER].map(typed)).toEqual(['0.1', '2000', '9007199254740991'])
})
