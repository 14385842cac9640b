import { expect, test } from 'vitest'
import { Camera } from '../../src/sketch/camera'
import type { View } from '../../src/sketch/viewport'

const WINDOW = { width: 440, height: 700 }
const PAPER = { width: 900, height: 1200 }

/** Two sheets that look where the other does. */
function linked(other = PAPER, extent = PAPER) {
  let told = 0
  const tell = (to: () => Camera, from: () => Camera) => (view: View) => {
    told++
    if (told > 50) throw new Error('they go on and on')
    to().follow(view, from().isWhole)
  }
  const one: Camera = new Camera(
    tell(
      () => two,
      () => one,
    ),
  )
  const two: Camera = new Camera(
    tell(
      () => one,
      () => two,
    ),
  )
  one.open(PAPER, extent)
  two.open(other, extent)
  for (const camera of [one, two]) camera.resize(WINDOW)
  return { one, two }
}

test('what is fitted shows as much as the widest sheet needs, in the middle', () => {
  const { one, two } = linked({ width: 2400, height: 1200 }, { width: 2400, height: 1200 })
  expect(one.view.scale).toBeCloseTo(two.view.scale)
  expect(one.view.y).toBeCloseTo(two.view.y)
  expect(2 * one.view.x + 900 * one.view.scale).toBeCloseTo(WINDOW.width)
})

test('one sheet follows the other’s height and scale, and keeps its own place across', () => {
  const { one, two } = linked()
  one.zoom(2, [100, 600])
  one.pan([-30, -80])
  expect(two.view.scale).toBe(one.view.scale)
  expect(two.view.y).toBe(one.view.y)
  expect(two.view.x).not.toBe(one.view.x)
})

test('both stay whole where the window changes, and neither does once one was moved', () => {
  const { one, two } = linked()
  for (const camera of [one, two]) camera.resize({ width: 300, height: 500 })
  expect(two.view).toEqual(one.view)
  expect([one.isWhole, two.isWhole]).toEqual([true, true])
  one.zoom(1.5)
  expect([one.isWhole, two.isWhole]).toEqual([false, false])
})
