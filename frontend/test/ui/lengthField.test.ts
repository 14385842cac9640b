// @vitest-environment jsdom
import 'fake-indexeddb/auto'
import { beforeEach, expect, test } from 'vitest'
import { Studio } from '../../src/studio/studio'
import { lengthField } from '../../src/ui/lengthField'
import { TRUNK } from '../builders'

let studio: Studio
let element: HTMLElement
let canvas: HTMLElement
const field = () => element.querySelector('input')!
const press = (key: string) => field().dispatchEvent(new KeyboardEvent('keydown', { key, cancelable: true }))

beforeEach(() => {
  studio = new Studio()
  const made = lengthField(studio, () => canvas)
  element = made.element
  canvas = Object.assign(document.createElement('div'), { tabIndex: 0 })
  document.body.replaceChildren(canvas, element)
  made.look({ scale: 1, x: 0, y: 0 })
})

test('a line that was just drawn asks for its length', () => {
  expect(element.hidden).toBe(true)
  studio.sketchbook.draw('scale', TRUNK)
  expect([element.hidden, document.activeElement]).toEqual([false, field()])
  field().value = '1,8'
  press('Enter')
  expect(studio.store.strokes.scale).toEqual({ points: TRUNK, metres: 1.8 })
  expect([element.hidden, document.activeElement]).toEqual([true, canvas])
})

test('a line that is selected shows its length, and Escape leaves it as it was', () => {
  studio.sketchbook.draw('scale', TRUNK)
  studio.sketchbook.measure(2.5)
  studio.sketchbook.select(null)
  studio.sketchbook.select({ kind: 'scale', index: 0 })
  expect(field().value).toBe('2.5')
  field().value = '9'
  press('Escape')
  expect([studio.store.strokes.scale?.metres, studio.store.state.selection]).toEqual([2.5, null])
})

test('what is no length is said there and not taken', () => {
  studio.sketchbook.draw('scale', TRUNK)
  const before = studio.store.strokes.scale
  for (const written of ['0', 'two', '']) {
    field().value = written
    press('Enter')
    expect(element.querySelector('[role=alert]')!.textContent).toContain('above 0')
    expect([studio.store.strokes.scale, element.hidden]).toEqual([before, false])
  }
})

test('its button deletes the line', () => {
  studio.sketchbook.draw('scale', TRUNK)
  element.querySelector('button')!.click()
  expect([studio.store.strokes.scale, element.hidden]).toEqual([null, true])
})
