import { expect, test } from 'vitest'
import { keyCommand, stepFrom } from '../../src/sketch/keys'

const SHEET = { width: 1000, height: 500 }
const key = (name: string, change = {}) =>
  keyCommand({ key: name, shiftKey: false, ctrlKey: false, metaKey: false, altKey: false, ...change })
const walk = (name: string, shiftKey: boolean) => {
  const command = key(name, { shiftKey })
  if (command?.type !== 'step') throw new Error('not a step')
  return stepFrom([500, 250], command, SHEET)
}

test('an arrow key goes 2 % of the longer side, and with Shift 0.25 %', () => {
  expect(walk('ArrowLeft', false)).toEqual([480, 250])
  expect(walk('ArrowDown', false)).toEqual([500, 270])
  expect(walk('ArrowRight', true)).toEqual([502.5, 250])
  expect(walk('ArrowUp', true)).toEqual([500, 247.5])
})

test('no step leads off the sheet', () => {
  const step = { type: 'step', right: 1, down: -1, fine: false } as const
  expect(stepFrom([995, 3], step, SHEET)).toEqual([1000, 0])
})

test('Enter, Escape, Delete, 0 and 1 are commands', () => {
  expect(['Enter', 'Escape', 'Delete', 'Backspace', '0', '1'].map(name => key(name)?.type)).toEqual([
    'pen',
    'escape',
    'remove',
    'remove',
    'fit',
    'actual',
  ])
})

test('plus and minus undo each other', () => {
  const [bigger, smaller] = [key('+'), key('-')]
  if (bigger?.type !== 'zoom' || smaller?.type !== 'zoom') throw new Error('not a zoom')
  expect(bigger.factor * smaller.factor).toBe(1)
  expect(key('=')).toEqual(bigger)
})

test("the browser's and the page's shortcuts are left alone", () => {
  expect(key('0', { ctrlKey: true })).toBeNull()
  expect(key('ArrowLeft', { altKey: true })).toBeNull()
  expect(key('-', { metaKey: true })).toBeNull()
  expect(key('z')).toBeNull()
})
