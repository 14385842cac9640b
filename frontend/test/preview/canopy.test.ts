import { describe, expect, it } from 'vitest'
import { canopyOf, groundShadow, lightAt } from '../../src/preview/canopy'
import { SUN } from '../../src/preview/sun'

/** Leaves filling a ball of radius 1 around (0, 2, 0). */
function ball(): number[] {
  const leaves: number[] = []
  for (let x = -1; x <= 1; x += 0.1)
    for (let y = -1; y <= 1; y += 0.1)
      for (let z = -1; z <= 1; z += 0.1) if (x * x + y * y + z * z <= 1) leaves.push(x, y + 2, z)
  return leaves
}

describe('the light in a ball of leaves', () => {
  const canopy = canopyOf(ball(), SUN)
  const lit = (...point: number[]) => lightAt(canopy, point)

  it('reaches its rim more than its middle', () => {
    const [sky, sun] = lit(0, 2, 0)
    const [skyAbove] = lit(0, 2.95, 0)
    const [, sunTowards] = lit(SUN[0] * 0.9, 2 + SUN[1] * 0.9, SUN[2] * 0.9)
    expect(skyAbove!).toBeGreaterThan(sky! * 1.7)
    expect(sunTowards!).toBeGreaterThan(sun! * 2.5)
  })

  it('reaches the side of the sun and hardly the other', () => {
    const [, towards] = lit(SUN[0] * 0.9, 2 + SUN[1] * 0.9, SUN[2] * 0.9)
    const [, away] = lit(-SUN[0] * 0.9, 2 - SUN[1] * 0.9, -SUN[2] * 0.9)
    expect(away!).toBeLessThan(towards! / 2.5)
  })

  it('has two bytes a vertex', () => {
    expect(lightAt(canopy, [0, 2, 0, 1, 2, 0])).toHaveLength(4)
  })
})

it('lights a single leaf', () => {
  const light = lightAt(canopyOf([0, 1, 0], SUN), [0, 1, 0])
  expect(Math.min(...light)).toBeGreaterThan(150)
})

it('throws the shadow away from the sun, and nowhere else', () => {
  const side = 32
  const shadow = groundShadow(ball(), SUN, { centre: [0, 0], radius: 4, side })
  const fall = 2 / SUN[1]
  const byte = (x: number, z: number) =>
    shadow[Math.floor(((z / 4 + 1) / 2) * side) * side + Math.floor(((x / 4 + 1) / 2) * side)]!
  expect(byte(-SUN[0] * fall, -SUN[2] * fall)).toBeGreaterThan(200)
  expect(byte(SUN[0] * fall, SUN[2] * fall)).toBe(0)
})
