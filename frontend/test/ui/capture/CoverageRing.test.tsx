// @vitest-environment jsdom
import 'fake-indexeddb/auto'
import { act } from 'preact/test-utils'
import { beforeEach, expect, test, vi } from 'vitest'
import { NO_STROKES, withPhoto } from '../../../src/strokes'
import { Studio } from '../../../src/studio/studio'
import { CoverageRing } from '../../../src/ui/capture/CoverageRing'
import { captureSheets, TRUNK } from '../../builders'
import { ringOf } from '../../preview/capture/cameras'
import { mount } from '../mount'

let studio: Studio

beforeEach(() => {
  vi.stubGlobal('matchMedia', () => ({ matches: true }))
  studio = new Studio()
})

function ring(count: number, names = Array.from({ length: count }, (_, at) => `${at}.jpg`)): HTMLElement {
  const cameras = ringOf(16).slice(0, count)
  studio.store.set({ sheets: captureSheets(names, { id: null, cameras }) })
  return mount(studio, <CoverageRing />)
}

const sentence = (host: HTMLElement) => host.querySelector('p')!.textContent
const listed = (host: HTMLElement) => [...host.querySelectorAll('li')].map(item => item.textContent)

test('before the cameras are found there is no ring', () => {
  studio.store.set({ sheets: captureSheets() })
  expect(mount(studio, <CoverageRing />).querySelector('details')!.hidden).toBe(true)
})

test('half a ring says from where more photos would help, also as a list', () => {
  const host = ring(9)
  expect(sentence(host)).toBe('More photos would help from the left.')
  expect(listed(host).slice(2, 5)).toEqual([
    '2.jpg: from the front, to the right',
    '3.jpg: from the right',
    '4.jpg: from the right',
  ])
  expect(host.querySelectorAll('.plan-gap')).toHaveLength(1)
})

test('directions are those from the photo with the trunk', () => {
  const host = ring(9)
  const strokes = withPhoto(NO_STROKES, '4.jpg', { ...NO_STROKES, branches: [{ points: TRUNK }] })
  void act(() => studio.store.set({ history: { past: [], present: strokes, future: [] } }))
  expect(listed(host)[4]).toBe('4.jpg: from the front')
  expect(sentence(host)).toBe('More photos would help from behind.')
})

test('a click on a photo draws on it, and it is marked', () => {
  const host = ring(9)
  const choose = vi.spyOn(studio.captures, 'choose').mockImplementation(() => {})
  host.querySelectorAll('.plan-photo')[2]!.dispatchEvent(new MouseEvent('click', { bubbles: true }))
  expect(choose).toHaveBeenCalledWith('2.jpg')
  expect(host.querySelectorAll('.plan-photo.chosen title')[0]!.textContent).toContain('0.jpg')
})
