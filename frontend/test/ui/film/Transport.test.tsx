// @vitest-environment jsdom
import 'fake-indexeddb/auto'
import { act } from 'preact/test-utils'
import { expect, test, vi } from 'vitest'
import { Playhead } from '../../../src/playhead'
import { Studio } from '../../../src/studio/studio'
import { Transport } from '../../../src/ui/film/Transport'
import { mount, redraw } from '../mount'

const MEASURED = { seconds: 3, frames: 60, framesPerSecond: 30 }

function shown(span = MEASURED as Parameters<Playhead['setSpan']>[1], gain?: { now: number; set(gain: number): void }) {
  const playhead = new Playhead(() => 0)
  playhead.setSpan('tree', span)
  const studio = new Studio()
  const part = () => <Transport playhead={playhead} {...(gain && { gain })} />
  const host = mount(studio, part())
  return { playhead, host, again: () => redraw(host, studio, part()) }
}

test('it plays and pauses', () => {
  const { playhead, host, again } = shown()
  const button = () => host.querySelector<HTMLElement>('.transport-play')!
  void act(() => button().click())
  again()
  expect([playhead.playing, button().getAttribute('aria-label')]).toEqual([true, 'Pause'])
  void act(() => button().click())
  expect(playhead.playing).toBe(false)
})

test('the slider goes to a frame, and says it', () => {
  const { playhead, host, again } = shown()
  const slider = host.querySelector<HTMLInputElement>('.transport-place')!
  slider.value = '1'
  void act(() => void slider.dispatchEvent(new Event('input', { bubbles: true })))
  again()
  expect([playhead.frame, host.querySelector('.transport-time')!.textContent]).toEqual([30, '31 / 601.0 s'])
  expect(slider.getAttribute('aria-valuetext')).toBe('frame 31 / 60, 1.0 seconds')
})

test('a clip that was dragged goes on playing once it is let go', () => {
  const { playhead, host } = shown()
  playhead.play()
  const slider = host.querySelector<HTMLInputElement>('.transport-place')!
  for (const type of ['pointerdown', 'input'])
    void act(() => void slider.dispatchEvent(new Event(type, { bubbles: true })))
  expect(playhead.playing).toBe(false)
  void act(() => void slider.dispatchEvent(new Event('pointerup', { bubbles: true })))
  expect(playhead.playing).toBe(true)
})

test('after the frames it leads back to the start; wind has no frames', () => {
  const { playhead, host, again } = shown()
  playhead.seek(2.5)
  again()
  expect(host.querySelector('.transport-frame')!.textContent).toBe('back to the start')
  expect(shown({ seconds: 4 }).host.querySelector('.transport-frame')).toBeNull()
})

test('strength is set where a tree moves', () => {
  const set = vi.fn()
  expect(shown().host.querySelector('.transport-gain')).toBeNull()
  const { host } = shown(MEASURED, { now: 0, set })
  expect(host.querySelector('.transport-gain')!.textContent).toContain('calm')
  const slider = host.querySelector<HTMLInputElement>('.transport-gain input')!
  slider.value = '2'
  void act(() => void slider.dispatchEvent(new Event('input', { bubbles: true })))
  expect(set).toHaveBeenCalledWith(2)
})

test('nothing is shown where nothing moves', () => {
  expect(shown(null).host.textContent).toBe('')
})
