// @vitest-environment jsdom
import 'fake-indexeddb/auto'
import { act } from 'preact/test-utils'
import { afterEach, beforeEach, expect, test, vi } from 'vitest'
import { Studio } from '../../../src/studio/studio'
import { text } from '../../../src/text'
import { HintLine } from '../../../src/ui/drawing/HintLine'
import { CROWN, photoSheets, TRUNK } from '../../builders'
import { mount } from '../mount'

let studio: Studio
const said = () => document.querySelector('.hint-text')!.textContent!
const button = (label: string) =>
  [...document.querySelectorAll('button')].find(({ textContent }) => textContent === label)!

/** Show the line on a device whose main pointer is a finger, or is none. */
async function on(device: 'phone' | 'computer'): Promise<void> {
  vi.stubGlobal('matchMedia', (query: string) => ({ matches: query.includes('fine') === (device === 'computer') }))
  studio = new Studio()
  studio.store.set({ sheets: photoSheets() })
  mount(studio, <HintLine />)
}

/** Press somewhere with a pointer of a type. */
function press(pointerType: string): Promise<void> {
  return act(() => {
    dispatchEvent(Object.assign(new Event('pointerdown'), { pointerType }))
  })
}

beforeEach(() => on('computer'))
afterEach(() => vi.unstubAllGlobals())

test('a phone says how to draw with a finger, whatever was pressed, and a computer how with the mouse', async () => {
  expect(said()).toContain(text.hints.how.mouse.crown)
  await on('phone')
  expect(said()).toContain('with your finger')
  await press('mouse')
  expect(said()).toContain('with your finger')
  expect(said()).not.toContain('button')
})

test('the line speaks of the pointer that was used last; one of an unknown type is a mouse', async () => {
  const how = []
  for (const type of ['touch', 'pen', '']) {
    await press(type)
    how.push(said().replace(text.hints.crown, '').trim())
  }
  const { touch, pen, mouse } = text.hints.how
  expect(how).toEqual([touch.crown, pen.crown, mouse.crown])
})

test('a fault is an alert, and its stroke can be deleted there', async () => {
  await act(() => {
    studio.strokes.draw('crown', CROWN)
    studio.strokes.draw('branch', TRUNK)
    studio.store.fault('strokes', { text: 'Too short.', stroke: { kind: 'branch', index: 0 } })
  })
  expect(document.querySelector('[role=alert]')!.textContent).toBe('Too short.')
  await act(() => button(text.hints.deleteStroke).click())
  expect([studio.store.strokes.branches, document.querySelector('[role=alert]')]).toEqual([[], null])
})

test('what is selected can be deleted from the line', async () => {
  await act(() => {
    studio.strokes.draw('crown', CROWN)
    studio.strokes.select({ kind: 'crown', index: 0 })
  })
  await act(() => button(text.hints.delete).click())
  expect(studio.store.strokes.crown).toBeNull()
})
