import { expect, test } from 'vitest'
import { NO_STROKES, withSheet, withStroke } from '../../src/strokes'
import { sketchFrom, sketchToWire } from '../../src/studio/sketches'
import { CROWN, TRUNK } from '../builders'

const drawn = { ...withStroke(NO_STROKES, 'branch', TRUNK, 9), crown: CROWN }

test('a sketch is read as it was written, with its paper and its brushes', () => {
  const written = JSON.parse(JSON.stringify(sketchToWire(drawn, 'front', { width: 120, height: 100 })))
  expect(sketchFrom(written)).toEqual({ strokes: drawn, size: { width: 120, height: 100 } })
})

test('each sheet is written alone', () => {
  const both = withSheet(NO_STROKES, 'side', drawn)
  expect(sketchToWire(both, 'side', { width: 1, height: 1 }).branches).toHaveLength(1)
  expect(sketchToWire(both, 'front', { width: 1, height: 1 }).branches).toEqual([])
})

test('a sketch without a size gets a sheet with room for it', () => {
  const { size } = sketchFrom({ branches: [{ points: TRUNK }] })
  expect(size.width).toBeGreaterThan(50)
  expect(size.height).toBeGreaterThan(95)
})

test('a value of another form is refused', () => {
  expect(() => sketchFrom({ branches: 3 })).toThrow(TypeError)
  expect(() => sketchFrom(null)).toThrow(TypeError)
})
