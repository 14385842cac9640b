import { expect, test } from 'vitest'
import { labelPlace } from '../../src/sketch/lengthLabel'
import type { Line } from '../../src/strokes'

const VIEW = { scale: 2, x: 10, y: 20 }
const BOX = { width: 100, height: 30 }

test('a line’s label lies beside its middle and clear of it, whichever way it was drawn', () => {
  const upright: Line = [
    [50, 10],
    [50, 30],
  ]
  const [x, y] = labelPlace(upright, VIEW, BOX)
  expect(x - BOX.width / 2).toBeGreaterThan(2 * 50 + 10)
  expect(y).toBeCloseTo(60, 6)
  expect(labelPlace([upright[1]!, upright[0]!], VIEW, BOX)).toEqual([x, y])
})

test('the label of a level line lies below it', () => {
  const level: Line = [
    [10, 10],
    [30, 10],
  ]
  const [x, y] = labelPlace(level, VIEW, BOX)
  expect(y - BOX.height / 2).toBeGreaterThan(2 * 10 + 20)
  expect(x).toBeCloseTo(50, 6)
})

test('a line without length has a label, too', () => {
  const point: Line = [
    [5, 5],
    [5, 5],
  ]
  expect(labelPlace(point, VIEW, BOX).every(Number.isFinite)).toBe(true)
})
