import { describe, expect, test } from 'vitest'
import {
  centreView,
  clampView,
  type Frame,
  fitView,
  panBy,
  panIntoView,
  scaleLimits,
  toScreen,
  toSheet,
  type View,
  zoomAbout,
} from '../../src/sketch/viewport'
import type { Point } from '../../src/strokes'

const FRAME: Frame = { sheet: { width: 1200, height: 1541 }, window: { width: 1440, height: 900 } }
const POINTS: Point[] = [
  [0, 0],
  [1200, 1541],
  [0.25, 1540.99],
  [617.3, 411.77],
]
const VIEWS: View[] = [0.01, 0.3, 0.5528877, 1, 3.3, 40].flatMap(scale => [
  { scale, x: 0, y: 0 },
  { scale, x: -12345.678, y: 0.1 },
])

describe.each(VIEWS)('at $scale, $x, $y', view => {
  test('a point converted to the window and back is the same point', () => {
    for (const point of POINTS) {
      const [x, y] = toSheet(view, toScreen(view, point))
      expect(Math.hypot(x - point[0], y - point[1]) * view.scale).toBeLessThan(1e-9)
    }
  })

  test('zooming keeps the point under the pointer', () => {
    for (const factor of [0.1, 0.9, 1, 1.2, 7]) {
      const [x, y] = toScreen(zoomAbout(view, factor, [333.3, 444.4], FRAME), toSheet(view, [333.3, 444.4]))
      expect(Math.hypot(x - 333.3, y - 444.4)).toBeLessThan(1e-6)
    }
  })

  test('the scale stays within its limits', () => {
    const [least, most] = scaleLimits(FRAME)
    expect(zoomAbout(view, 1e9, [0, 0], FRAME).scale).toBe(most)
    expect(zoomAbout(view, 1e-9, [0, 0], FRAME).scale).toBe(least)
  })

  test('some of the sheet stays in the window however far it is panned', () => {
    for (const by of [
      [1e6, 1e6],
      [-1e6, 1e6],
      [-1e6, -1e6],
    ] as const) {
      const clamped = clampView(panBy(view, by), FRAME)
      const [left, top] = toScreen(clamped, [0, 0])
      const [right, bottom] = toScreen(clamped, [1200, 1541])
      expect(Math.min(right, 1440) - Math.max(left, 0)).toBeGreaterThan(Math.min(80, 1200 * view.scale) - 1e-6)
      expect(Math.min(bottom, 900) - Math.max(top, 0)).toBeGreaterThan(Math.min(80, 1541 * view.scale) - 1e-6)
    }
  })
})

test('panning back and forth ends where it began', () => {
  expect(panBy(panBy({ scale: 2, x: 5, y: 6 }, [8, -3]), [-8, 3])).toEqual({ scale: 2, x: 5, y: 6 })
})

test('a fitted sheet is whole and in the middle, and touches the margin', () => {
  const view = fitView(FRAME)
  const [left, top] = toScreen(view, [0, 0])
  const [right, bottom] = toScreen(view, [1200, 1541])
  expect(left).toBeCloseTo(1440 - right, 9)
  expect(top).toBeCloseTo(24, 9)
  expect(bottom).toBeCloseTo(900 - 24, 9)
  expect(left).toBeGreaterThan(24)
})

test('the scale is limited to half of the fitted one and to 40 CSS px for each sheet px', () => {
  expect(scaleLimits(FRAME)).toEqual([fitView(FRAME).scale / 2, 40])
})

test('a view of a whole sheet is not clamped', () => {
  const view = fitView(FRAME)
  expect(clampView(view, FRAME)).toEqual(view)
})

test('a centred point is in the middle of the window', () => {
  const [x, y] = toScreen(centreView(3.7, [17, 40], FRAME), [17, 40])
  expect(x).toBeCloseTo(720, 9)
  expect(y).toBeCloseTo(450, 9)
})

test('the view pans just far enough to show a point, and not at all where it is in view', () => {
  const view = { scale: 2, x: 0, y: 0 }
  expect(panIntoView(view, [300, 200], 40, FRAME)).toEqual(view)
  expect(panIntoView(view, [1000, 5], 40, FRAME)).toEqual({ scale: 2, x: -600, y: 30 })
})
