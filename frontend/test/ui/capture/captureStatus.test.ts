import { expect, test } from 'vitest'
import { EMPTY, type State } from '../../../src/state'
import { text } from '../../../src/text'
import { captureProgress } from '../../../src/ui/capture/captureStatus'
import { capturePhoto, captureSheets, captureState, photoSheets } from '../../builders'

const NAMES = ['0.jpg', '1.jpg', '2.jpg', '3.jpg', '4.jpg']
const { status } = text.capture

function state(changes: Partial<State> = {}): State {
  return { ...EMPTY, sheets: captureSheets(NAMES), ...changes }
}

const said = (changes: Partial<State> = {}) => captureProgress(state(changes))

test('a tree of one photo has no such line', () => {
  expect(said({ sheets: photoSheets() })).toBeNull()
})

test('photos under way are counted', () => {
  const sheets = captureSheets(NAMES, { chosen: 18 })
  expect(said({ sheets, sending: true })).toMatchObject({ words: status.sending(6, 18), done: 5 / 18, steps: [] })
  expect(said({ sheets, sending: true, online: false })?.words).toBe(text.progress.offline)
})

test('photos that a reload left behind are asked for', () => {
  const sheets = captureSheets(NAMES, { chosen: 18 })
  expect(said({ sheets })).toEqual({ words: status.missing(5, 18), steps: ['chooseAgain', 'goOn'] })
  const few = captureSheets(NAMES.slice(0, 2), { chosen: 18 })
  expect(said({ sheets: few })?.steps).toEqual(['chooseAgain'])
})

test('too few photos are a fault with advice', () => {
  expect(said({ sheets: captureSheets(NAMES.slice(0, 3)) })).toMatchObject({
    words: status.tooFew(3, 5),
    isFault: true,
    steps: ['more', 'advice'],
  })
})

test('the search says its step, how far it is, and the time that is left', () => {
  const solve = captureState({ status: 'running', phase: 'solve', progress: 0.418, eta_s: 80 })
  const found = said({ solve })
  expect(found).toMatchObject({ done: 0.418, steps: ['cancel'] })
  expect(found?.words).toBe(`${status.phases.solve} · ${text.progress.percentAndTime(0.41, 80)}`)
})

test('a search that waits says what is ahead of it', () => {
  expect(said({ solve: captureState({ status: 'queued', queue_position: 3 }) })?.words).toBe(status.ahead(2))
  expect(said({ solve: captureState({ status: 'queued', queue_position: 1 }) })?.words).toBe(status.queued)
})

test('a set that cannot be used is said in the service’s words, with advice; what may pass is tried again', () => {
  const error = { code: 'no_parallax', detail: 'They were taken from one place.', retryable: false }
  const solve = captureState({ status: 'failed', error })
  expect(said({ solve })).toEqual({ words: error.detail, isFault: true, steps: ['more', 'advice'] })
  const crash = { ...solve, error: { ...error, retryable: true } }
  expect(said({ solve: crash })?.steps).toContain('again')
})

test('at the end it says how many photos are used', () => {
  const photos = NAMES.map((name, at) => capturePhoto(name, { used: at > 0 }))
  const solve = captureState({ status: 'solved' })
  expect(said({ sheets: captureSheets(NAMES, { photos }), solve })?.words).toBe(status.used(4, 5))
  const all = photos.map(photo => ({ ...photo, used: true }))
  expect(said({ sheets: captureSheets(NAMES, { photos: all }), solve })?.words).toBe(status.allUsed(5))
})

test('a capture that is gone asks for its photos', () => {
  expect(said({ sheets: captureSheets(NAMES, { id: null }) })).toMatchObject({
    words: status.lost,
    steps: ['chooseAgain'],
  })
})
