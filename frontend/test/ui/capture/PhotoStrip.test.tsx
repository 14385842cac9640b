// @vitest-environment jsdom
import { act } from 'preact/test-utils'
import { beforeEach, expect, test, vi } from 'vitest'
import { begin } from '../../../src/history'
import { photoDrawnOn } from '../../../src/sheets'
import { Store } from '../../../src/state'
import { NO_STROKES, withPhoto, withStroke } from '../../../src/strokes'
import type { Studio } from '../../../src/studio/studio'
import { text } from '../../../src/text'
import { PhotoStrip } from '../../../src/ui/capture/PhotoStrip'
import { CROWN, capturePhoto, captureSheets, photoSheets } from '../../builders'
import { mount } from '../mount'

const NAMES = ['00.jpg', '01.jpg', '02.jpg']
const { strip } = text.capture

let store: Store
let studio: Studio

beforeEach(() => {
  vi.stubGlobal(
    'IntersectionObserver',
    class {
      observe() {}
      disconnect() {}
    },
  )
  store = new Store()
  const choose = vi.fn((name: string) => store.set({ sheets: captureSheets([name, ...NAMES]) }))
  studio = { store, captures: { choose }, thumbnails: { of: async () => null } } as unknown as Studio
})

const photos = (host: HTMLElement) => [...host.querySelectorAll<HTMLElement>('.strip-photo')]

test('there is no strip for one photo', () => {
  store.set({ sheets: photoSheets() })
  expect(mount(studio, <PhotoStrip />).textContent).toBe('')
})

test('each photo says its place, its strokes, and whether and why it is not used', () => {
  const blurred = capturePhoto('02.jpg', { used: false, reason: { code: 'blurred', detail: 'less sharp' } })
  const all = [capturePhoto('00.jpg', { used: true }), capturePhoto('01.jpg'), blurred]
  const strokes = withPhoto(NO_STROKES, '00.jpg', withStroke(NO_STROKES, 'crown', CROWN))
  store.set({ sheets: captureSheets(NAMES, { photos: all }), history: begin(strokes) })
  const host = mount(studio, <PhotoStrip />)
  expect(
    photos(host).map(({ ariaLabel, attributes }) => ariaLabel ?? attributes.getNamedItem('aria-label')!.value),
  ).toEqual([
    `${strip.photo(1, 3, '00.jpg')}, ${strip.drawn}, ${strip.used}`,
    `${strip.photo(2, 3, '01.jpg')}, ${strip.pending}`,
    `${strip.photo(3, 3, '02.jpg')}, ${strip.unused}: ${strip.reasons.blurred}`,
  ])
  expect(photos(host).map(({ tabIndex }) => tabIndex)).toEqual([0, -1, -1])
})

test('what is pointed at says below why it is not used', () => {
  const far = capturePhoto('01.jpg', { used: false, reason: { code: 'new_code', detail: 'It is of the sea.' } })
  store.set({ sheets: captureSheets(NAMES, { photos: [capturePhoto('00.jpg'), far] }) })
  const host = mount(studio, <PhotoStrip />)
  const note = () => host.querySelector('.strip-note')!.textContent
  expect(note()).toBe('')
  act(() => void photos(host)[1]!.dispatchEvent(new MouseEvent('pointerenter')))
  expect(note()).toBe(strip.notUsed('01.jpg', 'It is of the sea.'))
  act(() => void photos(host)[1]!.dispatchEvent(new MouseEvent('pointerleave')))
  expect(note()).toBe('')
})

test('arrow keys go to the next photo, which is drawn on then', () => {
  store.set({ sheets: captureSheets(NAMES) })
  const host = mount(studio, <PhotoStrip />)
  const press = (key: string) =>
    act(() => void photos(host)[0]!.dispatchEvent(new KeyboardEvent('keydown', { key, bubbles: true })))
  press('ArrowRight')
  expect(photoDrawnOn(store.state)).toBe('01.jpg')
  press('x')
  expect(studio.captures.choose).toHaveBeenCalledTimes(1)
})

test('photos that are to come have their places', () => {
  store.set({ sheets: captureSheets(NAMES, { chosen: 5 }) })
  expect(mount(studio, <PhotoStrip />).querySelectorAll('.strip-awaited')).toHaveLength(2)
})
