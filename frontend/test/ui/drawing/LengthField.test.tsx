// @vitest-environment jsdom
import 'fake-indexeddb/auto'
import { act } from 'preact/test-utils'
import { beforeEach, expect, test } from 'vitest'
import { Studio } from '../../../src/studio/studio'
import { LengthField } from '../../../src/ui/drawing/LengthField'
import { TRUNK } from '../../builders'
import { mount } from '../mount'

let studio: Studio
const canvas = () => document.getElementById('canvas')!
const element = () => document.querySelector('.length-field')
const field = () => element()!.querySelector('input')!
const draw = () => act(() => studio.strokes.draw('scale', TRUNK))
const press = (key: string) =>
  act(() => void field().dispatchEvent(new KeyboardEvent('keydown', { key, bubbles: true, cancelable: true })))
const write = (value: string) =>
  act(() => {
    field().value = value
    field().dispatchEvent(new InputEvent('input', { bubbles: true }))
  })

beforeEach(async () => {
  studio = new Studio()
  mount(
    studio,
    <>
      <button type="button" id="canvas" />
      <LengthField view={{ scale: 1, x: 0, y: 0 }} leave={() => canvas().focus()} />
    </>,
  )
})

test('a line that was just drawn asks for its length', async () => {
  expect(element()).toBeNull()
  await draw()
  expect(document.activeElement).toBe(field())
  await write('1,8')
  await press('Enter')
  expect(studio.store.strokes.scale).toEqual({ points: TRUNK, metres: 1.8 })
  expect([element(), document.activeElement]).toEqual([null, canvas()])
})

test('a line that is selected shows its length, and Escape leaves it as it was', async () => {
  await draw()
  await act(() => studio.strokes.measure(2.5))
  await act(() => studio.strokes.select(null))
  await act(() => studio.strokes.select({ kind: 'scale', index: 0 }))
  expect(field().value).toBe('2.5')
  await write('9')
  await press('Escape')
  expect([studio.store.strokes.scale?.metres, studio.store.state.selection]).toEqual([2.5, null])
})

test('what is not a length is refused with a message and stays in the field', async () => {
  await draw()
  const before = studio.store.strokes.scale
  for (const written of ['0', 'two', '']) {
    await write(written)
    await press('Enter')
    expect(element()!.querySelector('[role=alert]')!.textContent).toBe('Enter a length from 0.001 m to 1,000 m.')
    expect([field().value, field().getAttribute('aria-invalid')]).toEqual([written, 'true'])
    expect(studio.store.strokes.scale).toBe(before)
  }
})

test('its button deletes the line', async () => {
  await draw()
  await act(() => element()!.querySelector('button')!.click())
  expect([studio.store.strokes.scale, element()]).toEqual([null, null])
})
