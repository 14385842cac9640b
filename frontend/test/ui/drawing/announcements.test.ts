import { expect, test } from 'vitest'
import { advance, begin, redo, undo } from '../../../src/history'
import { paper } from '../../../src/sheets'
import { type State, Store } from '../../../src/state'
import { type Line, NO_STROKES, withoutStroke, withScale, withSheet, withStroke } from '../../../src/strokes'
import { text } from '../../../src/text'
import { announceDrawing, announcePen, editText } from '../../../src/ui/drawing/announcements'
import { answer, drawnAnswer, sketchSheets } from '../../builders'

const LOOP: Line = [
  [0, 0],
  [9, 0],
  [9, 9],
]
const TRUNK: Line = [
  [5, 20],
  [5, 5],
]
const empty = begin(NO_STROKES)
const crowned = advance(empty, withStroke(empty.present, 'crown', LOOP))
const trunked = advance(crowned, withStroke(crowned.present, 'branch', TRUNK))
const branched = advance(trunked, withStroke(trunked.present, 'branch', [...TRUNK]))

test('what was drawn is named', () => {
  expect(editText(empty, crowned)).toBe('Drawn: Crown.')
  expect(editText(crowned, trunked)).toBe('Drawn: Trunk.')
  expect(editText(trunked, branched)).toBe('Drawn: Branch 2.')
})

test('a crown drawn again is a drawn crown, not a deleted one', () => {
  expect(editText(crowned, advance(crowned, withStroke(crowned.present, 'crown', [...LOOP])))).toBe('Drawn: Crown.')
})

test('what was deleted is named as it was', () => {
  const without = advance(branched, withoutStroke(branched.present, { kind: 'branch', index: 1 }))
  expect(editText(branched, without)).toBe('Deleted: Branch 2.')
})

test('clearing, undoing and redoing are told apart', () => {
  const cleared = advance(branched, NO_STROKES)
  expect(editText(branched, cleared)).toBe('All strokes cleared.')
  expect(editText(cleared, undo(cleared))).toBe('Undone.')
  expect(editText(undo(branched), redo(undo(branched)))).toBe('Redone.')
})

test('nothing is said of another drawing', () => {
  expect(editText(branched, begin(withStroke(NO_STROKES, 'crown', LOOP)))).toBeNull()
})

test('a measured line is named, and its length when it is entered', () => {
  const lined = advance(trunked, withScale(trunked.present, [...TRUNK], 1))
  const measured = advance(lined, withScale(lined.present, lined.present.scale!.points, 1.8))
  const moved = advance(measured, withScale(measured.present, [TRUNK[0]!, [1, 1]], 1.8))
  const branchedToo = advance(moved, withStroke(moved.present, 'branch', [...TRUNK]))
  expect([editText(trunked, lined), editText(lined, measured), editText(measured, moved)]).toEqual([
    'Drawn: Measured line.',
    'The measured line is 1.8 m long.',
    'Moved: Measured line.',
  ])
  expect(editText(moved, branchedToo)).toBe('Drawn: Branch 2.')
})

test('a stroke on the other sheet is named with its sheet', () => {
  const side = withSheet(trunked.present, 'side', withStroke(NO_STROKES, 'branch', [...TRUNK]))
  expect(editText(trunked, advance(trunked, side))).toBe('Drawn: Trunk (left side).')
})

test('strokes that come all at once were opened, not drawn', () => {
  expect(editText(empty, advance(empty, branched.present))).toBe('Drawing opened.')
})

test('tools, sheets and what is selected are said, until it is ended', () => {
  const store = new Store()
  store.set({ sheets: sketchSheets(paper(), paper()) })
  const end = announceDrawing(store)
  const saidOf = (change: Partial<State>) => {
    store.set(change)
    return store.state.announcement
  }
  expect(saidOf({})).toBe('')
  expect(saidOf({ tool: 'branch' })).toBe(text.tools.chosen.branch)
  expect(saidOf({ active: 'side' })).toBe(text.sheets.activated.side)
  expect(saidOf({ selection: { kind: 'branch', index: 0, sheet: 'side' } })).toBe('Selected: Trunk (left side).')
  expect(saidOf({ history: crowned })).toBe('Drawn: Crown.')
  end()
  expect(saidOf({ tool: 'crown' })).toBe('Drawn: Crown.')
})

test('the traced branches are counted by the skeleton’s tips', () => {
  const store = new Store()
  const end = announceDrawing(store)
  const { skeleton } = drawnAnswer().front
  store.set({ traced: { of: NO_STROKES, answer: { ...answer(), skeleton } } })
  expect(store.state.announcement).toBe('2 branches found.')
  end()
})

test('the place of the keyboard’s pen is announced as shares of the sheet', () => {
  const store = new Store()
  const said = (pen: 'down' | 'up' | 'move') => {
    announcePen(store, pen, [225, 900], paper())
    return store.state.announcement
  }
  expect([said('down'), said('move'), said('up')]).toEqual([
    'Pen down, 25% from the left, 75% from the top.',
    '25% from the left, 75% from the top.',
    'Pen up.',
  ])
})
