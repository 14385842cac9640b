import { expect, test } from 'vitest'
import { EMPTY } from '../src/state'
import { NO_STROKES } from '../src/strokes'
import { tracedInSpace, tracedOn } from '../src/tracedOn'
import { answer, camera, captureAnswer, captureSheets, photoSheets } from './builders'

const RING: [number, number][] = [
  [10, 10],
  [20, 10],
  [20, 20],
]

function traced(answer = captureAnswer()) {
  return { of: NO_STROKES, answer }
}

test('branches of many photos are seen by the camera of the photo that is drawn on', () => {
  const sheets = captureSheets(['00.jpg', '01.jpg'], { cameras: [camera('00.jpg')] })
  const seen = tracedOn({ ...EMPTY, sheets, traced: traced() })
  expect(seen?.skeleton.points).toEqual([
    [50, 70],
    [50, 30],
  ])
  expect(seen?.skeleton.radii).toEqual([10, 5])
})

test('each photo shows its own foliage', () => {
  const sheets = captureSheets(['00.jpg', '01.jpg'], { cameras: [camera('00.jpg'), camera('01.jpg')] })
  const found = traced(captureAnswer({ photos: [{ photo: '01.jpg', foliage: [RING] }] }))
  expect(tracedOn({ sheets, traced: found })?.foliage).toEqual([])
  const other = captureSheets(['01.jpg'], { cameras: [camera('01.jpg')] })
  expect(tracedOn({ sheets: other, traced: found })?.foliage).toEqual([RING])
})

test('the same answer in the same photo is the same value', () => {
  const state = { sheets: captureSheets(['00.jpg'], { cameras: [camera('00.jpg')] }), traced: traced() }
  expect(tracedOn(state)).toBe(tracedOn({ ...state }))
})

test('a photo without a camera shows nothing', () => {
  expect(tracedOn({ sheets: captureSheets(), traced: traced() })).toBeNull()
})

test('the answer about one photo is shown as it is, and is not one in space', () => {
  const found = { of: NO_STROKES, answer: answer() }
  expect(tracedOn({ sheets: photoSheets(), traced: found })).toBe(found.answer)
  expect(tracedInSpace({ traced: found })).toBeNull()
})
