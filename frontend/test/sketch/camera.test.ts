import { expect, test } from 'vitest'
import { Camera } from '../../src/sketch/camera'
import type { View } from '../../src/sketch/viewport'

const WINDOW = { width: 440, height: 700 }
const PAPER = { width: 900, height: 1200 }

/** Two cameras that follow each other. */
function linked(other = PAPER, extent = PAPER) {
  let changes = 0
  const link = (to: () => Camera, from: () => Camera) => (view: View) => {
    changes++
    if (changes > 50) throw new Error('the cameras follow each other without end')
    to().follow(view, from().isWhole)
  }
  const one: Camera = new Camera(
    link(
      () => two,
      () => one,
    ),
  )
  const two: Camera = new Camera(
    link(
      () => one,
      () => two,
    ),
  )
  one.open(PAPER, extent)
  two.open(other, extent)
  for (const camera of [one, two]) camera.resize(WINDOW)
  return { one, two }
}

test('a fitted sheet has the scale that the widest sheet needs, and lies in the middle', () => {
  const { one, two } = linked({ width: 2400, height: 1200 }, { width: 2400, height: 1200 })
  expect(one.view.scale).toBeCloseTo(two.view.scale)
  expect(one.view.y).toBeCloseTo(two.view.y)
  expect(2 * one.view.x + 900 * one.view.scale).toBeCloseTo(WINDOW.width)
})

test('one sheet follows the other’s scale and vertical offset, and keeps its own horizontal one', () => {
  const { one, two } = linked()
  one.zoom(2, [100, 600])
  one.pan([-30, -80])
  expect(two.view.scale).toBe(one.view.scale)
  expect(two.view.y).toBe(one.view.y)
  expect(two.view.x).not.toBe(one.view.x)
})

test('both stay fitted where the window changes, and neither does once one was moved', () => {
  const { one, two } = linked()
  for (const camera of [one, two]) camera.resize({ width: 300, height: 500 })
  expect(two.view).toEqual(one.view)
  expect([one.isWhole, two.isWhole]).toEqual([true, true])
  one.zoom(1.5)
  expect([one.isWhole, two.isWhole]).toEqual([false, false])
})
