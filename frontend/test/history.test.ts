import { expect, test } from 'vitest'
import { advance, begin, mapHistory, redo, undo } from '../src/history'

const steps = (count: number) => Array.from({ length: count }, (_, step) => step + 1)
const walked = (count: number) => steps(count).reduce(advance<number>, begin(0))

test('every step can be undone, to the beginning', () => {
  const before = steps(1000).reduce(undo, walked(1000))
  expect(before.present).toBe(0)
  expect(before.past).toEqual([])
  expect(before.future).toEqual(steps(1000))
})

test('each redo reverts an undo', () => {
  const there = walked(5)
  expect(redo(redo(undo(undo(there))))).toEqual(there)
})

test('at either end undo and redo change nothing', () => {
  expect(undo(begin('a'))).toEqual(begin('a'))
  expect(redo(walked(3))).toEqual(walked(3))
})

test('a new value after an undo removes what was undone', () => {
  const elsewhere = advance(undo(walked(3)), 9)
  expect(elsewhere).toEqual({ past: [0, 1, 2], present: 9, future: [] })
  expect(redo(elsewhere).present).toBe(9)
})

test('advancing to the same value is no step', () => {
  const there = undo(walked(2))
  expect(advance(there, there.present)).toBe(there)
})

test('a change throughout the history applies to everything that can be undone and redone', () => {
  const doubled = mapHistory(undo(walked(3)), step => 2 * step)
  expect(doubled).toEqual({ past: [0, 2], present: 4, future: [6] })
})
