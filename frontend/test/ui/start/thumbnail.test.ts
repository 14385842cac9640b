import { expect, test } from 'vitest'
import { afterGap } from '../../../src/ui/start/thumbnail'

const SKY = [180, 200, 230, 255]
const WHITE = [255, 255, 255, 255]

function row(...pixels: number[][]): Uint8ClampedArray {
  return new Uint8ClampedArray(pixels.flat())
}

test('the 3/4 view begins behind the white gap', () => {
  expect(afterGap(row(SKY, SKY, WHITE, WHITE, SKY, SKY, SKY))).toBe(4)
})

test('a picture without a gap is taken whole', () => {
  expect(afterGap(row(SKY, SKY, SKY))).toBe(0)
})
