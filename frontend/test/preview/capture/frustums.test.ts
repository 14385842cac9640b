import type { Mesh } from 'three'
import { afterEach, expect, test, vi } from 'vitest'
import { screenOf, treePose } from '../../../src/preview/camera'
import { Frustums } from '../../../src/preview/capture/frustums'
import { pictureCorners, standpoint } from '../../../src/preview/capture/photoCamera'
import { boxOfCameras, heightInPhotos, placeUntraced } from '../../../src/preview/capture/placement'
import { IDENTITY, moved } from '../../../src/preview/capture/similarity'
import { ringOf } from './cameras'

const RING = ringOf(12)
const VIEWPORT = { width: 800, height: 600 }
const WORLD = placeUntraced(RING, null)
const POSE = treePose(boxOfCameras(RING, WORLD), 0.3, 1, 800 / 600)

afterEach(() => {
  vi.restoreAllMocks()
})

function shown(): Frustums {
  const frustums = new Frustums(() => {})
  frustums.show(RING, heightInPhotos(RING))
  return frustums
}

test('a click on a photo’s picture finds the photo, one beside all of them none', () => {
  const frustums = shown()
  for (const camera of RING.slice(0, 4)) {
    const [first, , third] = pictureCorners(camera, standpoint(camera, IDENTITY), 0.13 * heightInPhotos(RING))
    const middle = [0, 1, 2].map(axis => (first![axis]! + third![axis]!) / 2) as [number, number, number]
    expect(frustums.at(screenOf(POSE, moved(WORLD, middle), VIEWPORT), WORLD, POSE, VIEWPORT)).toBe(camera.photo)
  }
  expect(frustums.at([2, 2], WORLD, POSE, VIEWPORT)).toBeNull()
})

test('what is shown anew, or no longer, is disposed of', () => {
  const frustums = shown()
  const gone = vi.fn()
  for (const part of frustums.group.children) (part as Mesh).geometry.addEventListener('dispose', gone)
  const count = frustums.group.children.length
  frustums.choose('3.jpg')
  expect(gone).toHaveBeenCalledTimes(count)
  frustums.dispose()
  expect(frustums.group.children).toHaveLength(0)
})
