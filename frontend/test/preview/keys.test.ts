import { expect, it, vi } from 'vitest'
import { press } from '../../src/preview/keys'

const keyed = () => ({ orbit: vi.fn(), zoom: vi.fn(), view: vi.fn(), turnLeaves: vi.fn() })

it.each([
  ['1', 'photo'],
  ['2', 'front'],
  ['3', 'side'],
  ['4', 'back'],
  ['5', 'top'],
])('shows with key %s the view %s', (key, view) => {
  const viewer = keyed()
  expect(press(key, viewer)).toBe(true)
  expect(viewer.view).toHaveBeenCalledExactlyOnceWith(view)
})

it.each([
  ['ArrowLeft', -1, 0],
  ['ArrowRight', 1, 0],
  ['ArrowUp', 0, -1],
  ['ArrowDown', 0, 1],
])('orbits with %s', (key, azimuth, polar) => {
  const viewer = keyed()
  press(key, viewer)
  expect(viewer.orbit.mock.calls[0]!.map(Math.sign)).toEqual([azimuth, polar])
})

it('comes closer with + and goes back by as much with -', () => {
  const viewer = keyed()
  press('+', viewer)
  press('-', viewer)
  const [[closer], [back]] = viewer.zoom.mock.calls as [[number], [number]]
  expect(closer).toBeGreaterThan(1)
  expect(closer * back).toBeCloseTo(1, 12)
})

it('turns the leaves with L and leaves other keys alone', () => {
  const viewer = keyed()
  expect(press('l', viewer)).toBe(true)
  expect(viewer.turnLeaves).toHaveBeenCalledOnce()
  for (const key of ['Tab', '0', '6', 'Enter', 'x', ' ']) expect(press(key, viewer)).toBe(false)
})
