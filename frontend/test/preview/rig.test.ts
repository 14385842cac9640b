// @vitest-environment jsdom
import { Vector3 } from 'three'
import { beforeEach, expect, test } from 'vitest'
import { projected, type Vec3, VIEW_SLOPE } from '../../src/preview/camera'
import { cameraPose } from '../../src/preview/capture/photoCamera'
import { IDENTITY } from '../../src/preview/capture/similarity'
import { Rig } from '../../src/preview/rig'
import { cameraAt } from './capture/cameras'

const VIEWPORT = { width: 600, height: 400 }
const POSE = cameraPose(cameraAt('a.jpg', [1.5, 0.2, 1], [0, 0.6, 0], 0.1), IDENTITY, [0, 0.5, 0], VIEWPORT)
const POINTS: Vec3[] = [
  [0, 0, 0],
  [0.3, 0.9, -0.2],
  [-0.2, 0.5, 0.4],
]

let rig: Rig

beforeEach(() => {
  rig = new Rig(document.createElement('canvas'), {
    reducedMotion: () => false,
    damped: () => false,
    onTurn: () => {},
    onMove: () => {},
  })
  rig.resize(VIEWPORT.width / VIEWPORT.height)
})

function drawnAt(point: Vec3): [number, number] {
  rig.camera.updateMatrixWorld()
  const { x, y } = new Vector3(...point).project(rig.camera)
  return [((x + 1) / 2) * VIEWPORT.width, ((1 - y) / 2) * VIEWPORT.height]
}

test('what is drawn lies where a photo’s camera shows it, with its roll and its axis off the middle', () => {
  rig.moveTo(POSE, true)
  for (let frame = 0; frame < 3; frame++) rig.step(1 / 60)
  for (const point of POINTS) {
    const [x, y] = projected(POSE, point, VIEWPORT)
    expect(drawnAt(point)).toEqual([expect.closeTo(x, 3), expect.closeTo(y, 3)])
  }
  expect(rig.holds).toBe(true)
})

test('a flight ends in the photo’s camera and holds it', () => {
  rig.fly(POSE, 0.5, true)
  expect(rig.holds).toBe(false)
  for (let frame = 0; frame < 40; frame++) rig.step(1 / 60)
  expect(rig.holds).toBe(true)
  expect(drawnAt(POINTS[1]!)[0]).toBeCloseTo(projected(POSE, POINTS[1]!, VIEWPORT)[0], 3)
})

test('a pose that is not held is brought back to the lens of the other views, upright', () => {
  rig.moveTo(POSE)
  for (let frame = 0; frame < 240; frame++) rig.step(1 / 60)
  const { slope, roll, shift } = rig.pose
  expect([slope, roll, shift]).toEqual([VIEW_SLOPE, 0, [0, 0]])
})
