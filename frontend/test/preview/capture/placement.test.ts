import { expect, test } from 'vitest'
import { standpoint } from '../../../src/preview/capture/photoCamera'
import {
  alignment,
  azimuthOf,
  boxOfCameras,
  heightInPhotos,
  lookedAt,
  placeTraced,
  placeUntraced,
} from '../../../src/preview/capture/placement'
import { after, IDENTITY, moved, placing } from '../../../src/preview/capture/similarity'
import { cameraAt, ringOf } from './cameras'

const RING = ringOf(9)
const TREE = placing([0, 0.2, 0], [0, 0, 0], { turn: 0.4, scale: 3 })

function close(point: readonly number[], expected: readonly number[], digits = 6): void {
  expected.forEach((value, at) => {
    expect(point[at]).toBeCloseTo(value, digits)
  })
}

test('cameras look at the point nearest to their axes', () => {
  close(lookedAt(RING), [0, 1.5, 0], 4)
  const level = cameraAt('b.jpg', [0, 1, 5], [0, 1, 0])
  expect(lookedAt([level]).every(Number.isFinite)).toBe(true)
})

test('before a trace, what the cameras look at is in the middle and the front’s camera stands before it', () => {
  const world = placeUntraced(RING, '2.jpg')
  close(moved(world, [0, 1.5, 0]), [0, 0.45, 0], 4)
  expect(azimuthOf(standpoint(RING[2]!, world).centre)).toBeCloseTo(0, 6)
  expect(heightInPhotos(RING) * Math.hypot(...world[0].slice(0, 3))).toBeCloseTo(1, 6)
})

test('after a trace the tree’s frame is kept, scaled as before', () => {
  const world = placeTraced(RING, TREE)
  close(moved(world, [0, 0.2, 0]), [0, 0, 0])
  expect(heightInPhotos(RING) * Math.hypot(...world[0].slice(0, 3))).toBeCloseTo(1, 6)
})

test('the way to a model’s frame is found by the cameras that both have', () => {
  const there = RING.slice(0, 5).map(camera => {
    const { centre, right, down, forward } = standpoint(camera, TREE)
    const row = (axis: readonly number[]) =>
      [...axis, -axis.reduce((sum, value, at) => sum + value * centre[at]!, 0)] as [number, number, number, number]
    return { ...camera, camera_from_world: [row(right), row(down), row(forward)] as typeof camera.camera_from_world }
  })
  const found = alignment(RING, there)!
  close(found.flat(), TREE.flat())
  close(after(found, IDENTITY).flat(), TREE.flat())
  expect(alignment(RING, [{ ...there[0]!, photo: 'other.jpg' }, there[1]!])).toBeNull()
})

test('the box holds every camera, and the tree that is expected', () => {
  const { min, max } = boxOfCameras(RING, placeUntraced(RING, null))
  expect(Math.min(-min[0], max[0], -min[2], max[2])).toBeGreaterThan(0.4)
  expect(max[1]).toBeGreaterThanOrEqual(0.9)
})
