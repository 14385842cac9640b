import { expect, test } from 'vitest'
import { distanceToLine, simplified } from '../src/plane'
import type { Line, Point } from '../src/strokes'

const WAVE: Line = Array.from({ length: 200 }, (_, at): Point => [at, 20 * Math.sin(at / 20)])

test('a simplified line keeps its ends and its shape with fewer points', () => {
  const few = simplified(WAVE, 0.5)
  expect([few[0], few.at(-1)]).toEqual([WAVE[0], WAVE.at(-1)])
  expect(few.length).toBeLessThan(25)
  expect(Math.max(...WAVE.map(place => distanceToLine(few, place)))).toBeLessThanOrEqual(0.5)
})

test('a simplified straight line is its two ends', () => {
  const straight: Line = Array.from({ length: 9 }, (_, at): Point => [at, 2 * at])
  expect(simplified(straight, 0.1)).toEqual([straight[0], straight.at(-1)])
})
