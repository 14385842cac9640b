import { describe, expect, it } from 'vitest'
import { isSoftware, softwarePixelRatio } from '../../src/preview/software'

it.each([
  ['ANGLE (Google, Vulkan 1.3.0 (SwiftShader Device (Subzero) (0x0000C0DE)), SwiftShader driver)', true],
  ['llvmpipe (LLVM 15.0.6, 256 bits)', true],
  ['ANGLE (Microsoft, Microsoft Basic Render Driver Direct3D11 vs_5_0 ps_5_0, D3D11)', true],
  ['ANGLE (NVIDIA, NVIDIA GeForce RTX 3060 Direct3D11 vs_5_0 ps_5_0, D3D11)', false],
  ['Apple GPU', false],
  ['Mesa Intel(R) UHD Graphics 620 (KBL GT2)', false],
])('recognizes whether %s draws on the processor', (renderer, software) => {
  expect(isSoftware(renderer)).toBe(software)
})

describe('the pixel ratio of a processor', () => {
  it.each([
    [320, 240],
    [800, 600],
    [1440, 900],
    [3840, 2160],
  ])('of %i x %i is lower while something moves, and never above 0.75', (width, height) => {
    const [rest, moving] = [softwarePixelRatio({ width, height }, false), softwarePixelRatio({ width, height }, true)]
    expect(moving).toBeLessThan(rest)
    expect(rest).toBeLessThanOrEqual(0.75)
    expect(moving).toBeGreaterThanOrEqual(0.3)
  })
})
