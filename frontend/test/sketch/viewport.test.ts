import { describe, expect, test } from 'vitest'
import {
  centred,
  clampView,
  type Frame,
  fitted,
  limits,
  panBy,
  showing,
  toPhoto,
  toScreen,
  type View,
  zoomAbout,
} from '../../src/sketch/viewport'
import type { Point } from '../../src/strokes'

const FRAME: Frame = { photo: { width: 1200, height: 1541 }, window: { width: 1440, height: 900 } }
const PLACES: Point[] = [
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
  test('a place mapped to the window and back is the same place', () => {
    for (const place of PLACES) {
      const [x, y] = toPhoto(view, toScreen(view, place))
      expect(Math.hypot(x - place[0], y - place[1]) * view.scale).toBeLessThan(1e-9)
    }
  })

  test('zooming keeps the place under the pointer', () => {
    for (const factor of [0.1, 0.9, 1, 1.2, 7]) {
      const [x, y] = toScreen(zoomAbout(view, factor, [333.3, 444.4], FRAME), toPhoto(view, [333.3, 444.4]))
      expect(Math.hypot(x - 333.3, y - 444.4)).toBeLessThan(1e-6)
    }
  })

  test('the scale stays within its limits', () => {
    const [least, most] = limits(FRAME)
    expect(zoomAbout(view, 1e9, [0, 0], FRAME).scale).toBe(most)
    expect(zoomAbout(view, 1e-9, [0, 0], FRAME).scale).toBe(least)
  })

  test('some of the photo stays in the window however far it is panned', () => {
    for (const by of [
      [1e6, 1e6],
      [-1e6, 1e6],
      [-1e6, -1e6],
    ] as const) {
      const kept = clampView(panBy(view, by), FRAME)
      const [left, top] = toScreen(kept, [0, 0])
      const [right, bottom] = toScreen(kept, [1200, 1541])
      expect(Math.min(right, 1440) - Math.max(left, 0)).toBeGreaterThan(Math.min(80, 1200 * view.scale) - 1e-6)
      expect(Math.min(bottom, 900) - Math.max(top, 0)).toBeGreaterThan(Math.min(80, 1541 * view.scale) - 1e-6)
    }
  })
})

test('panning back and forth ends where it began', () => {
  expect(panBy(panBy({ scale: 2, x: 5, y: 6 }, [8, -3]), [-8, 3])).toEqual({ scale: 2, x: 5, y: 6 })
})

test('fitted, the whole photo is in sight and in the middle, and touches the margin', () => {
  const view = fitted(FRAME)
  const [left, top] = toScreen(view, [0, 0])
  const [right, bottom] = toScreen(view, [1200, 1541])
  expect(left).toBeCloseTo(1440 - right, 9)
  expect(top).toBeCloseTo(24, 9)
  expect(bottom).toBeCloseTo(900 - 24, 9)
  expect(left).toBeGreaterThan(24)
})

test('limits are half of fitted and 40 CSS px for each photo px', () => {
  expect(limits(FRAME)).toEqual([fitted(FRAME).scale / 2, 40])
})

test('a view of a photo that is in sight is not clamped', () => {
  const view = fitted(FRAME)
  expect(clampView(view, FRAME)).toEqual(view)
})

test('a centred place is in the middle of the window', () => {
  const [x, y] = toScreen(centred(3.7, [17, 40], FRAME), [17, 40])
  expect(x).toBeCloseTo(720, 9)
  expect(y).toBeCloseTo(450, 9)
})

test('the view moves just as far as shows a place, and not where it is in sight', () => {
  const view = { scale: 2, x: 0, y: 0 }
  expect(showing(view, [300, 200], 40, FRAME)).toEqual(view)
  expect(showing(view, [1000, 5], 40, FRAME)).toEqual({ scale: 2, x: -600, y: 30 })
})
