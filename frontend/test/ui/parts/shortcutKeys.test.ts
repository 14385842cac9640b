import { expect, test } from 'vitest'
import { commandOf } from '../../../src/ui/parts/shortcutKeys'

const key = (key: string, held: Partial<Record<'ctrlKey' | 'metaKey' | 'altKey' | 'shiftKey', boolean>> = {}) =>
  commandOf({ key, ctrlKey: false, metaKey: false, altKey: false, shiftKey: false, ...held })

test('letters take the tools, in either case', () => {
  expect(['c', 'C', 'b', 'm', 'v'].map(letter => key(letter))).toEqual(['crown', 'crown', 'branch', 'scale', 'select'])
})

test('control or command undoes, and with shift redoes', () => {
  expect(key('z', { ctrlKey: true })).toBe('undo')
  expect(key('z', { metaKey: true })).toBe('undo')
  expect(key('Z', { ctrlKey: true, shiftKey: true })).toBe('redo')
  expect(key('y', { ctrlKey: true })).toBe('redo')
})

test('keys of the browser and of the system are left alone', () => {
  expect(key('c', { ctrlKey: true })).toBeNull()
  expect(key('s', { altKey: true })).toBeNull()
  expect(key('S', { ctrlKey: true, shiftKey: true })).toBeNull()
  expect(key('Tab')).toBeNull()
})

test('a question mark asks for help though it needs shift', () => {
  expect(key('?', { shiftKey: true })).toBe('help')
})
