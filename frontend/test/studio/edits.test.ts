import { expect, test } from 'vitest'
import { Store } from '../../src/state'
import { BranchEdits, editable, selectedJoint } from '../../src/studio/edits'
import { StrokeActions } from '../../src/studio/strokeActions'
import { captureAnswer, captureSheets } from '../builders'

const SKELETON = {
  points: [
    [0, 0, 0],
    [0, 1, 0],
    [0, 2, 0],
    [1, 1, 0],
  ] as [number, number, number][],
  radii: [0.4, 0.3, 0.2, 0.1],
  parents: [-1, 0, 1, 1],
  seen: [true, true, true, true],
}

function begin() {
  const store = new Store()
  const strokes = new StrokeActions(store)
  const edits = new BranchEdits(store, strokes)
  store.set({ sheets: captureSheets() })
  const answerEdits = (skeleton = SKELETON) =>
    store.set({ traced: { of: store.strokes, answer: captureAnswer({ skeleton }) } })
  answerEdits()
  edits.choose('move')
  return { store, strokes, edits, answerEdits }
}

test('a click selects a joint, one beside all branches none', () => {
  const { store, edits } = begin()
  edits.picked(2)
  expect(selectedJoint(store.state)).toBe(2)
  edits.picked(null)
  expect(selectedJoint(store.state)).toBeNull()
})

test('each edit names the joint by its place and can be undone', () => {
  const { store, strokes, edits } = begin()
  edits.moved(3, [2, 2, 2])
  expect(store.strokes.edits).toEqual([{ do: 'move', at: [1, 1, 0], to: [2, 2, 2] }])
  strokes.undo()
  expect(store.strokes.edits).toBeUndefined()
})

test('until the service has answered an edit, no other joint is taken', () => {
  const { store, edits, answerEdits } = begin()
  edits.drew(2, [[0, 3, 1]])
  expect(editable(store.state)).toBeNull()
  edits.picked(1)
  edits.moved(1, [5, 5, 5])
  expect(store.strokes.edits).toEqual([{ do: 'add', from: [0, 2, 0], points: [[0, 3, 1]] }])
  answerEdits()
  expect(editable(store.state)).not.toBeNull()
})

test('the joint that was edited is selected again in the answer', () => {
  const { store, edits, answerEdits } = begin()
  edits.picked(3)
  edits.setRadius(0.2)
  expect(store.strokes.edits).toEqual([{ do: 'radius', at: [1, 1, 0], radius: 0.2 }])
  answerEdits()
  expect(selectedJoint(store.state)).toBe(3)
})

test('removing takes the branch from the selected joint on', () => {
  const { store, edits } = begin()
  edits.remove()
  expect(store.strokes.edits).toBeUndefined()
  edits.picked(3)
  edits.remove()
  expect(store.strokes.edits).toEqual([{ do: 'remove', at: [1, 1, 0] }])
})

test('a piece is joined by a click on it and another on where it belongs', () => {
  const { store, edits } = begin()
  edits.choose('join')
  edits.picked(3)
  edits.picked(3)
  expect(store.strokes.edits).toBeUndefined()
  edits.picked(2)
  expect(store.strokes.edits).toEqual([{ do: 'join', at: [1, 1, 0], to: [0, 2, 0] }])
  expect(store.state.branchTool).toBe('move')
})

test('steps select joint after joint, and the end of editing selects none', () => {
  const { store, edits } = begin()
  edits.step('outward')
  edits.step('outward')
  expect(selectedJoint(store.state)).toBe(2)
  edits.choose(null)
  expect([store.state.branchTool, store.state.selection]).toEqual([null, null])
})
