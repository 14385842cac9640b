// @vitest-environment jsdom
import 'fake-indexeddb/auto'
import { afterEach, beforeEach, expect, test } from 'vitest'
import { paper } from '../../../src/sheets'
import { Studio } from '../../../src/studio/studio'
import { BRUSHES } from '../../../src/ui/drawing/DrawingFoot'
import { listenToShortcuts } from '../../../src/ui/drawing/shortcuts'
import { photoSheets, sketchSheets } from '../../builders'

let studio: Studio
let calls: string[]
let end: () => void

/** Press a key on an element; true where the page took it from the browser. */
function press(key: string, target: EventTarget = document.body, held: KeyboardEventInit = {}): boolean {
  return !target.dispatchEvent(new KeyboardEvent('keydown', { key, bubbles: true, cancelable: true, ...held }))
}

beforeEach(() => {
  document.body.replaceChildren()
  studio = new Studio()
  studio.store.set({ sheets: photoSheets() })
  calls = []
  const call = (name: string) => () => void calls.push(name)
  const zoom = { fit: call('fit'), actual: call('actual'), zoom: call('zoom') }
  end = listenToShortcuts(studio, zoom, call('other'))
})
afterEach(() => end())

test('letters choose tools, move the view and go to the other sheet', () => {
  expect(press('b')).toBe(true)
  expect(studio.store.state.tool).toBe('branch')
  for (const key of ['f', '1', 's']) press(key)
  expect(calls).toEqual(['fit', 'actual', 'other'])
})

test('what is typed into a field is left to it', () => {
  const field = document.body.appendChild(document.createElement('input'))
  expect([press('b', field), studio.store.state.tool]).toEqual([false, 'crown'])
})

test('keys are left alone while a dialog is open', () => {
  document.body.append(Object.assign(document.createElement('dialog'), { open: true }))
  expect([press('b'), studio.store.state.tool]).toEqual([false, 'crown'])
})

test('with nothing open only help and opening answer', () => {
  studio.store.set({ sheets: null })
  expect([press('b'), press('f'), press('?')]).toEqual([false, false, true])
  expect([calls, studio.store.state.dialog]).toEqual([[], 'shortcuts'])
})

test('brackets change the brush on paper only', () => {
  press(']')
  expect(studio.store.state.brush).toBeNull()
  studio.store.set({ sheets: sketchSheets(paper()) })
  press(']')
  expect(studio.store.state.brush).toBe(BRUSHES[1][0])
})

test('after the end no key is heard', () => {
  end()
  expect([press('b'), studio.store.state.tool]).toEqual([false, 'crown'])
})
