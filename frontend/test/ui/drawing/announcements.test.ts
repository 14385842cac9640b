import { expect, test } from 'vitest'
import { advance, begin, redo, undo } from '../../../src/history'
import { type Line, NO_STROKES, withoutStroke, withScale, withSheet, withStroke } from '../../../src/strokes'
import { editSaid } from '../../../src/ui/drawing/announcements'

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
  expect(editSaid(empty, crowned)).toBe('Crown drawn.')
  expect(editSaid(crowned, trunked)).toBe('Trunk drawn.')
  expect(editSaid(trunked, branched)).toBe('Branch 2 drawn.')
})

test('a crown drawn anew is a drawn crown, not a deleted one', () => {
  expect(editSaid(crowned, advance(crowned, withStroke(crowned.present, 'crown', [...LOOP])))).toBe('Crown drawn.')
})

test('what was deleted is named as it was', () => {
  const without = advance(branched, withoutStroke(branched.present, { kind: 'branch', index: 1 }))
  expect(editSaid(branched, without)).toBe('Branch 2 deleted.')
})

test('clearing, undoing and redoing are told apart', () => {
  const cleared = advance(branched, NO_STROKES)
  expect(editSaid(branched, cleared)).toBe('All strokes cleared.')
  expect(editSaid(cleared, undo(cleared))).toBe('Undone.')
  expect(editSaid(undo(branched), redo(undo(branched)))).toBe('Redone.')
})

test('nothing is said of another drawing', () => {
  expect(editSaid(branched, begin(withStroke(NO_STROKES, 'crown', LOOP)))).toBeNull()
})

test('a measured line is named, and its length when that is said', () => {
  const lined = advance(trunked, withScale(trunked.present, [...TRUNK], 1))
  const measured = advance(lined, withScale(lined.present, lined.present.scale!.points, 1.8))
  expect([editSaid(trunked, lined), editSaid(lined, measured)]).toEqual([
    'Measured line drawn.',
    'The measured line is 1.8 m long.',
  ])
})

test('what is drawn on the other sheet is told as such', () => {
  const side = withSheet(trunked.present, 'side', withStroke(NO_STROKES, 'branch', [...TRUNK]))
  expect(editSaid(trunked, advance(trunked, side))).toBe('Trunk, left side drawn.')
})

test('strokes that come all at once were opened, not drawn', () => {
  expect(editSaid(empty, advance(empty, branched.present))).toBe('Drawing opened.')
})
