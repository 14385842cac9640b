import { beforeEach, expect, test, vi } from 'vitest'
import { Playhead } from '../src/playhead'

let ms: number
let playhead: Playhead
const MEASURED = { seconds: 5, frames: 120, framesPerSecond: 30 }

beforeEach(() => {
  ms = 1000
  playhead = new Playhead(() => ms)
})

test('where there is nothing to play it does not play', () => {
  playhead.play()
  expect([playhead.playing, playhead.span, playhead.seconds, playhead.frame]).toEqual([false, null, 0, null])
})

test('it runs by the clock, at its speed, and begins again after the end', () => {
  playhead.setSpan('tree', MEASURED)
  playhead.play()
  ms += 2000
  expect([playhead.seconds, playhead.frame]).toEqual([2, 60])
  playhead.setSpeed(0.25)
  ms += 4000
  expect(playhead.seconds).toBe(3)
  playhead.setSpeed(1)
  ms += 3000
  expect([playhead.seconds, playhead.frame]).toEqual([1, 30])
  playhead.pause()
  ms += 700
  expect(playhead.seconds).toBe(1)
})

test('after the last frame it leads back, without a frame', () => {
  playhead.setSpan('tree', MEASURED)
  playhead.seek(4.5)
  expect(playhead.frame).toBeNull()
})

test('the tree goes before the clip, and the place stays', () => {
  playhead.setSpan('clip', { seconds: 4, frames: 120, framesPerSecond: 30 })
  playhead.showFrame(45)
  expect([playhead.frame, playhead.playing]).toEqual([45, false])
  playhead.setSpan('tree', MEASURED)
  expect([playhead.frame, playhead.span]).toEqual([45, MEASURED])
  playhead.setSpan('tree', { seconds: 1 })
  expect([playhead.frame, playhead.span?.seconds]).toEqual([null, 1])
  playhead.setSpan('tree', null)
  expect(playhead.span?.seconds).toBe(4)
})

test('whoever watches hears of every change, and of no span that is the same', () => {
  const heard = vi.fn()
  const end = playhead.watch(heard)
  playhead.setSpan('tree', MEASURED)
  playhead.setSpan('tree', { ...MEASURED })
  playhead.play()
  playhead.seek(1)
  playhead.pause()
  expect(heard).toHaveBeenCalledTimes(4)
  end()
  playhead.play()
  expect(heard).toHaveBeenCalledTimes(4)
})
