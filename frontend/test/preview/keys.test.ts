import { expect, it, vi } from 'vitest'
import { pressKey } from '../../src/preview/keys'

const target = () => ({ orbit: vi.fn(), zoom: vi.fn(), view: vi.fn(), toggleLeaves: vi.fn() })

it.each([
  ['1', 'photo'],
  ['2', 'front'],
  ['3', 'side'],
  ['4', 'back'],
  ['5', 'top'],
])('shows with key %s the view %s', (key, view) => {
  const viewer = target()
  expect(pressKey(key, viewer)).toBe(true)
  expect(viewer.view).toHaveBeenCalledExactlyOnceWith(view)
})

it.each([
  ['ArrowLeft', -1, 0],
  ['ArrowRight', 1, 0],
  ['ArrowUp', 0, -1],
  ['ArrowDown', 0, 1],
])('orbits with %s', (key, azimuth, polar) => {
  const viewer = target()
  pressKey(key, viewer)
  expect(viewer.orbit.mock.calls[0]!.map(Math.sign)).toEqual([azimuth, polar])
})

it('comes closer with + and goes back by as much with -', () => {
  const viewer = target()
  pressKey('+', viewer)
  pressKey('-', viewer)
  const [[closer], [back]] = viewer.zoom.mock.calls as [[number], [number]]
  expect(closer).toBeGreaterThan(1)
  expect(closer * back).toBeCloseTo(1, 12)
})

it('shows or hides the leaves with L and ignores other keys', () => {
  const viewer = target()
  expect(pressKey('l', viewer)).toBe(true)
  expect(viewer.toggleLeaves).toHaveBeenCalledOnce()
  for (const key of ['Tab', '0', '6', 'Enter', 'x', ' ']) expect(pressKey(key, viewer)).toBe(false)
})
