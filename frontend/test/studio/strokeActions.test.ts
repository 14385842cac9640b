import { beforeEach, expect, test } from 'vitest'
import { Store } from '../../src/state'
import { NO_STROKES } from '../../src/strokes'
import { Sketchbook } from '../../src/studio/strokeActions'
import { answer, CROWN, LIMB, TRUNK } from '../builders'

let store: Store
let sketchbook: Sketchbook

beforeEach(() => {
  store = new Store()
  sketchbook = new Sketchbook(store)
})

test('after the first crown the branch tool is at hand', () => {
  sketchbook.draw('crown', CROWN)
  expect(store.state.tool).toBe('branch')
  sketchbook.hold('crown')
  sketchbook.draw('crown', LIMB)
  expect(store.state.tool).toBe('crown')
})

test('every edit can be undone and done again, without end', () => {
  sketchbook.draw('crown', CROWN)
  for (let i = 0; i < 150; i++) sketchbook.draw('branch', TRUNK)
  const full = store.strokes
  sketchbook.clear()
  for (let i = 0; i < 152; i++) sketchbook.undo()
  expect(store.strokes).toBe(NO_STROKES)
  for (let i = 0; i < 151; i++) sketchbook.redo()
  expect(store.strokes).toBe(full)
})

test('a deleted stroke comes back where it was', () => {
  sketchbook.draw('crown', CROWN)
  for (const line of [TRUNK, LIMB]) sketchbook.draw('branch', line)
  const before = store.strokes
  sketchbook.select({ kind: 'branch', index: 0 })
  sketchbook.remove()
  expect(store.strokes.branches.map(branch => branch.points)).toEqual([LIMB])
  expect(store.state.selection).toBeNull()
  sketchbook.undo()
  expect(store.strokes).toBe(before)
})

test('a traced branch is deleted by a stroke that erases it', () => {
  sketchbook.draw('crown', CROWN)
  sketchbook.draw('branch', TRUNK)
  const skeleton = {
    points: [
      [50, 95],
      [50, 60],
      [50, 40],
      [70, 50],
    ] as [number, number][],
    radii: [4, 3, 2, 1],
    parents: [-1, 0, 1, 1],
    stroke: [0, 0, 0, -1],
  }
  store.set({ traced: { of: store.strokes, answer: { ...answer(), skeleton } } })
  sketchbook.select({ kind: 'traced', joint: 3 })
  sketchbook.remove()
  const [[from, to] = []] = store.strokes.erase
  const side = ([x, y]: readonly [number, number]) => Math.sign((70 - 50) * (y - 60) - (50 - 60) * (x - 50))
  expect(side(from!) * side(to!)).toBe(-1)
})

test('with nothing selected nothing is deleted', () => {
  sketchbook.draw('crown', CROWN)
  const before = store.state.history
  sketchbook.remove()
  expect(store.state.history).toBe(before)
})

test('a measured line is selected for its length, which is an edit of its own', () => {
  sketchbook.draw('scale', TRUNK)
  expect(store.state.selection).toEqual({ kind: 'scale', index: 0 })
  sketchbook.measure(1.8)
  sketchbook.measure(1.8)
  expect(store.strokes.scale).toEqual({ points: TRUNK, metres: 1.8 })
  sketchbook.undo()
  expect([store.strokes.scale?.points, store.strokes.scale?.metres === 1.8]).toEqual([TRUNK, false])
  sketchbook.redo()
  sketchbook.select({ kind: 'scale', index: 0 })
  sketchbook.remove()
  expect(store.strokes.scale).toBeNull()
})

test('an end that is moved leaves the length as it was said', () => {
  sketchbook.draw('scale', TRUNK)
  sketchbook.measure(1.8)
  sketchbook.draw('scale', [TRUNK[0]!, [60, 30]])
  expect(store.strokes.scale).toEqual({ points: [TRUNK[0], [60, 30]], metres: 1.8 })
})
