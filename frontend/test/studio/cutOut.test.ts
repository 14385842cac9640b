import { expect, test } from 'vitest'
import { readCutOut } from '../../src/studio/cutOut'

const HEAD = new Uint8Array([137, 80, 78, 71, 13, 10, 26, 10])
const png = (bytes = 0) => new Blob([HEAD, new Uint8Array(bytes)])
const alpha =
  (...pixels: number[]) =>
  async () =>
    Uint8Array.from(pixels)

test('a PNG that is partly transparent is used as it is', async () => {
  const leaf = await readCutOut(png(20), 4e6, alpha(255, 0, 255))
  expect([leaf.type, leaf.size]).toEqual(['image/png', 28])
})

test.each([
  ['another file', new Blob(['a photo of a leaf']), alpha(255, 0), 'not a PNG'],
  ['an empty file', new Blob([]), alpha(255, 0), 'not a PNG'],
  ['a picture that is too large', png(4_000_000), alpha(255, 0), 'at most 4 MB'],
  ['a picture without a transparent pixel', png(), alpha(255, 255), 'no transparent background'],
  ['a picture of nothing', png(), alpha(0, 0), 'fully transparent'],
  ['a damaged picture', png(), () => Promise.reject(new Error('broken')), 'damaged'],
])('%s is refused with a reason', async (_, file, alphaOf, reason) => {
  await expect(readCutOut(file, 4e6, alphaOf)).rejects.toThrow(reason)
})
