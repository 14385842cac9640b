// @vitest-environment jsdom
import { act } from 'preact/test-utils'
import { beforeEach, expect, test } from 'vitest'
import { Store } from '../../../src/state'
import { StrokeActions } from '../../../src/studio/strokeActions'
import type { Studio } from '../../../src/studio/studio'
import { text } from '../../../src/text'
import { DistanceForm } from '../../../src/ui/capture/DistanceForm'
import { camera, captureSheets } from '../../builders'
import { mount } from '../mount'

const NAMES = ['00.jpg', '01.jpg', '02.jpg']
const { distance: words } = text.capture

let store: Store
let studio: Studio

beforeEach(() => {
  HTMLElement.prototype.hidePopover = () => {}
  store = new Store()
  store.set({ sheets: captureSheets(NAMES, { cameras: NAMES.map(camera) }) })
  studio = { store, strokes: new StrokeActions(store) } as unknown as Studio
})

/** Fill the form in, and send it. */
function fill(host: HTMLElement, values: Readonly<Record<string, string>>): void {
  for (const [name, value] of Object.entries(values))
    host.querySelector<HTMLInputElement | HTMLSelectElement>(`[name=${name}]`)!.value = value
  const send = () => host.querySelector('form')!.dispatchEvent(new Event('submit', { cancelable: true, bubbles: true }))
  act(() => void send())
}

test('before the cameras are known there is no distance to set', () => {
  store.set({ sheets: captureSheets(NAMES) })
  expect(mount(studio, <DistanceForm />).textContent).toBe('')
})

test('the distance between two photos is set, and can be undone', () => {
  fill(mount(studio, <DistanceForm />), { from: '00.jpg', to: '02.jpg', metres: '4,2' })
  expect(store.strokes.distance).toEqual({ photos: ['00.jpg', '02.jpg'], metres: 4.2 })
  studio.strokes.undo()
  expect(store.strokes.distance).toBeUndefined()
})

test('one photo twice, and no length, are said', () => {
  const host = mount(studio, <DistanceForm />)
  const fault = () => host.querySelector('.fault')!.textContent
  fill(host, { from: '01.jpg', to: '01.jpg', metres: '3' })
  expect(fault()).toBe(words.same)
  fill(host, { from: '00.jpg', to: '01.jpg', metres: 'far' })
  expect(fault()).toBe(words.wrong)
  expect(store.strokes.distance).toBeUndefined()
})

test('a distance that is set is shown, and can be removed', () => {
  studio.strokes.setDistance({ photos: ['00.jpg', '02.jpg'], metres: 4.2 })
  const host = mount(studio, <DistanceForm />)
  expect(host.querySelector('button')!.getAttribute('aria-label')).toBe(words.now('00.jpg', '02.jpg', 4.2))
  const remove = [...host.querySelectorAll('button')].find(({ textContent }) => textContent === words.remove)!
  act(() => remove.click())
  expect(store.strokes.distance).toBeUndefined()
})
