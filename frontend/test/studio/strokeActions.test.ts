import { beforeEach, expect, test } from 'vitest'
import { Store } from '../../src/state'
import { NO_STROKES } from '../../src/strokes'
import { StrokeActions } from '../../src/studio/strokeActions'
import { answer, CROWN, LIMB, TRUNK } from '../builders'

let store: Store
let strokes: StrokeActions

beforeEach(() => {
  store = new Store()
  strokes = new StrokeActions(store)
})

test('after the first crown the branch tool is chosen', () => {
  strokes.draw('crown', CROWN)
  expect(store.state.tool).toBe('branch')
  strokes.chooseTool('crown')
  strokes.draw('crown', LIMB)
  expect(store.state.tool).toBe('crown')
})

test('every edit can be undone and redone, however many there are', () => {
  strokes.draw('crown', CROWN)
  for (let i = 0; i < 150; i++) strokes.draw('branch', TRUNK)
  const full = store.strokes
  strokes.clear()
  for (let i = 0; i < 152; i++) strokes.undo()
  expect(store.strokes).toBe(NO_STROKES)
  for (let i = 0; i < 151; i++) strokes.redo()
  expect(store.strokes).toBe(full)
})

test('a deleted stroke comes back where it was', () => {
  strokes.draw('crown', CROWN)
  for (const line of [TRUNK, LIMB]) strokes.draw('branch', line)
  const before = store.strokes
  strokes.select({ kind: 'branch', index: 0 })
  strokes.remove()
  expect(store.strokes.branches.map(branch => branch.points)).toEqual([LIMB])
  expect(store.state.selection).toBeNull()
  strokes.undo()
  expect(store.strokes).toBe(before)
})

test('a traced branch is deleted by a stroke that erases it', () => {
  strokes.draw('crown', CROWN)
  strokes.draw('branch', TRUNK)
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
  strokes.select({ kind: 'traced', joint: 3 })
  strokes.remove()
  const [[from, to] = []] = store.strokes.erase
  const side = ([x, y]: readonly [number, number]) => Math.sign((70 - 50) * (y - 60) - (50 - 60) * (x - 50))
  expect(side(from!) * side(to!)).toBe(-1)
})

test('with nothing selected nothing is deleted', () => {
  strokes.draw('crown', CROWN)
  const before = store.state.history
  strokes.remove()
  expect(store.state.history).toBe(before)
})

test('a measured line is selected so that its length can be set, which is another edit', () => {
  strokes.draw('scale', TRUNK)
  expect(store.state.selection).toEqual({ kind: 'scale', index: 0 })
  strokes.measure(1.8)
  strokes.measure(1.8)
  expect(store.strokes.scale).toEqual({ points: TRUNK, metres: 1.8 })
  strokes.undo()
  expect([store.strokes.scale?.points, store.strokes.scale?.metres === 1.8]).toEqual([TRUNK, false])
  strokes.redo()
  strokes.select({ kind: 'scale', index: 0 })
  strokes.remove()
  expect(store.strokes.scale).toBeNull()
})

test('moving an end keeps the length that was set', () => {
  strokes.draw('scale', TRUNK)
  strokes.measure(1.8)
  strokes.draw('scale', [TRUNK[0]!, [60, 30]])
  expect(store.strokes.scale).toEqual({ points: [TRUNK[0], [60, 30]], metres: 1.8 })
})
