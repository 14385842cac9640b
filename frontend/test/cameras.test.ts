import { expect, test } from 'vitest'
import { placeOf, seenBy, spotAt } from '../src/cameras'
import { camera } from './builders'

const TURNED = {
  ...camera('00.jpg'),
  camera_from_world: [
    [0, 0, -1, 1],
    [0, -1, 0, 2],
    [-1, 0, 0, 8],
  ] as ReturnType<typeof camera>['camera_from_world'],
}

test('a point before the camera is seen by its distance', () => {
  expect(seenBy(camera('00.jpg'), [2, -1, 10])).toEqual({ at: [60, 45], depth: 20, scale: 5 })
})

test('a seen point is found again at its depth', () => {
  const { at, depth } = seenBy(TURNED, [1.5, -0.5, 0.25])
  const [x, y, z] = spotAt(TURNED, at, depth)
  expect([x, y, z].map(value => Number(value.toFixed(9)))).toEqual([1.5, -0.5, 0.25])
})

test('a camera is where its own frame begins', () => {
  expect(placeOf(camera('00.jpg')).map(Math.abs)).toEqual([0, 0, 10])
  const [x, y, z] = placeOf(TURNED)
  expect([x, y, z]).toEqual([8, 2, 1])
})
