// @vitest-environment jsdom
import 'fake-indexeddb/auto'
import { beforeEach, expect, test, vi } from 'vitest'
import { Studio } from '../../../src/studio/studio'
import { FrameSlider, frameAfter } from '../../../src/ui/film/FrameSlider'
import { clipInfo } from '../../builders'
import { mount } from '../mount'

const look = vi.fn()
const choose = vi.fn()

beforeEach(() => vi.resetAllMocks())

function slider(frame = 10): HTMLElement {
  return mount(
    new Studio(),
    <FrameSlider clip={clipInfo()} frame={frame} look={look} choose={choose} />,
  ).querySelector<HTMLElement>('[role=slider]')!
}

test('it says which frame is drawn on, and when that is', () => {
  const element = slider()
  expect(element.getAttribute('aria-valuetext')).toBe('Frame 11 of 60, at 0.3 seconds')
  expect(element.querySelectorAll('img')).toHaveLength(12)
})

test('keys go frame by frame, and stop at the ends', () => {
  slider().dispatchEvent(new KeyboardEvent('keydown', { key: 'ArrowRight', bubbles: true }))
  expect(look).toHaveBeenCalledWith(11, true)
  expect([frameAfter('PageUp', 55, 60), frameAfter('Home', 7, 60), frameAfter('ArrowLeft', 0, 60)]).toEqual([59, 0, 0])
  expect(frameAfter('Tab', 7, 60)).toBeNull()
})
