import { describe, expect, it, test } from 'vitest'
import { projected, screenOf, type Vec3, zoomedLens } from '../../../src/preview/camera'
import { cameraPose, pictureCorners, pictureRect, standpoint } from '../../../src/preview/capture/photoCamera'
import { IDENTITY, moved, placing } from '../../../src/preview/capture/similarity'
import { cameraAt, seenAt } from './cameras'

const CAMERA = cameraAt('a.jpg', [4, 1.2, 3], [0.3, 2, -0.2], 0.12)
const WORLD = placing([0, 0, 0], [0.1, 0.2, 0], { turn: 0.7, scale: 0.25 })
const POINTS: Vec3[] = [
  [0, 0, 0],
  [0.4, 3, -0.3],
  [-1, 1, 0.8],
]

describe.each([
  ['wide', { width: 900, height: 500 }],
  ['high', { width: 390, height: 700 }],
])('a photo in a %s viewport', (_, viewport) => {
  const pose = cameraPose(CAMERA, WORLD, [0.1, 0.6, 0], viewport)
  const rect = pictureRect(CAMERA, pose, viewport)

  it('is as large as fits, in the middle', () => {
    expect(rect.width / rect.height).toBeCloseTo(1000 / 800, 9)
    expect(Math.min(rect.x, rect.y)).toBeCloseTo(0, 9)
    expect(rect.x + rect.width / 2).toBeCloseTo(viewport.width / 2, 9)
    expect(rect.y + rect.height / 2).toBeCloseTo(viewport.height / 2, 9)
  })

  it('lies under the world as its camera saw it, also where it is enlarged', () => {
    for (const enlarged of [pose, zoomedLens(pose, 2.5, [100, 80], viewport)]) {
      const { x, y, width } = pictureRect(CAMERA, enlarged, viewport)
      for (const point of POINTS) {
        const [px, py] = seenAt(CAMERA, point)
        const [shownX, shownY] = screenOf(enlarged, moved(WORLD, point), viewport)
        expect(shownX).toBeCloseTo(x + (px * width) / 1000, 6)
        expect(shownY).toBeCloseTo(y + (py * width) / 1000, 6)
      }
    }
  })

  it('stays where it is enlarged about', () => {
    const before = pictureRect(CAMERA, pose, viewport)
    const now = pictureRect(CAMERA, zoomedLens(pose, 3, [200, 150], viewport), viewport)
    expect((200 - now.x) / now.width).toBeCloseTo((200 - before.x) / before.width, 9)
    expect((150 - now.y) / now.height).toBeCloseTo((150 - before.y) / before.height, 9)
  })
})

test('a picture’s corners lie before its camera, where the photo’s corners are seen', () => {
  const corners = pictureCorners(CAMERA, standpoint(CAMERA, IDENTITY), 0.5)
  const px = corners.map(corner => seenAt(CAMERA, corner).map(Math.round))
  expect(px).toEqual([
    [0, 0],
    [1000, 0],
    [1000, 800],
    [0, 800],
  ])
})

test('a point before the camera has a depth, one behind it a negative one', () => {
  const viewport = { width: 100, height: 100 }
  const pose = cameraPose(CAMERA, IDENTITY, [0, 1, 0], viewport)
  expect(projected(pose, [0, 1, 0], viewport)[2]).toBeGreaterThan(4)
  expect(projected(pose, [8, 1, 6], viewport)[2]).toBeLessThan(0)
})
