import { expect, test } from 'vitest'
import {
  isEmpty,
  lineOf,
  NO_STROKES,
  onPhoto,
  photosDrawnOver,
  strokeAt,
  strokeRefs,
  viewsFromWire,
  viewsToWire,
  withDistance,
  withEdit,
  withoutStroke,
  withPhoto,
  withScale,
  withStroke,
} from '../src/strokes'
import { CROWN, LIMB, TRUNK } from './builders'

const FIRST = withStroke(withStroke(NO_STROKES, 'crown', CROWN), 'branch', TRUNK)
const TWO = withPhoto(withPhoto(NO_STROKES, '03.jpg', FIRST), '00.jpg', withStroke(NO_STROKES, 'crown', LIMB))

test('strokes over photos stay in the order in which these were first drawn over', () => {
  expect(photosDrawnOver(TWO)).toEqual(['03.jpg', '00.jpg'])
  const more = withPhoto(TWO, '03.jpg', withStroke(onPhoto(TWO, '03.jpg'), 'branch', LIMB))
  expect(photosDrawnOver(more)).toEqual(['03.jpg', '00.jpg'])
  expect(onPhoto(more, '03.jpg').branches).toHaveLength(2)
})

test('a photo without strokes is not among those drawn over', () => {
  expect(photosDrawnOver(withoutStroke(TWO, { kind: 'crown', index: 0, photo: '00.jpg' }))).toEqual(['03.jpg'])
})

test('each stroke is found by its photo', () => {
  expect(strokeRefs(TWO).map(({ kind, photo }) => `${photo} ${kind}`)).toEqual([
    '03.jpg crown',
    '03.jpg branch',
    '00.jpg crown',
  ])
  expect(lineOf(TWO, { kind: 'crown', index: 0, photo: '00.jpg' })).toEqual(LIMB)
})

test('an edit alone is worth keeping', () => {
  expect(isEmpty(withEdit(NO_STROKES, { do: 'remove', at: [0, 1, 0] }))).toBe(false)
})

test('a measured line and the distance between two photos take each other’s place', () => {
  const measured = withPhoto(TWO, '03.jpg', withScale(onPhoto(TWO, '03.jpg'), LIMB, 2))
  const apart = withDistance(measured, { photos: ['00.jpg', '03.jpg'], metres: 4.2 })
  expect(apart.scale).toBeNull()
  expect(strokeRefs(apart)).toHaveLength(3)
  const again = withPhoto(apart, '00.jpg', withScale(onPhoto(apart, '00.jpg'), LIMB, 3))
  expect(again.distance).toBeUndefined()
  expect(again.scale).toEqual({ points: LIMB, metres: 3, photo: '00.jpg' })
})

test('strokes over photos survive their file', () => {
  const measured = withPhoto(TWO, '03.jpg', withScale(onPhoto(TWO, '03.jpg'), LIMB, 2))
  expect(viewsFromWire(JSON.parse(JSON.stringify(viewsToWire(measured))))).toEqual(measured)
  const apart = withDistance(TWO, { photos: ['00.jpg', '03.jpg'], metres: 4.2 })
  expect(viewsFromWire(viewsToWire(apart))).toEqual(apart)
})

test('a photo without a crown is not sent: the service could not read it', () => {
  const lone = withPhoto(TWO, '07.jpg', withStroke(NO_STROKES, 'branch', LIMB))
  expect(viewsToWire(lone).views.map(({ photo }) => photo)).toEqual(['03.jpg', '00.jpg'])
})

test('the service’s pointers lead to the stroke over its photo', () => {
  const { views } = TWO
  expect(strokeAt('/views/views/0/branches/0/points', views)).toEqual({ kind: 'branch', index: 0, photo: '03.jpg' })
  expect(strokeAt('/views/1/crown', views)).toEqual({ kind: 'crown', index: 0, photo: '00.jpg' })
  expect(strokeAt('/views/9/crown', views)).toBeNull()
})
