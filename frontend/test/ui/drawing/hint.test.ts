import { expect, test } from 'vitest'
import type { StrokeWarning, TraceAnswer } from '../../../src/api/types'
import { advance, begin } from '../../../src/history'
import { paper } from '../../../src/sheets'
import { EMPTY, type State } from '../../../src/state'
import { type Line, NO_STROKES, withPhoto, withSheet, withStroke } from '../../../src/strokes'
import { text } from '../../../src/text'
import { hintOf } from '../../../src/ui/drawing/hint'
import { BO, session } from '../../accounts'
import {
  camera,
  captureAnswer,
  capturePhoto,
  captureSheets,
  grown,
  photo,
  photoSheets,
  shownModel,
  sketchSheets,
} from '../../builders'

const LINE: Line = [
  [0, 0],
  [9, 9],
]
const crown = withStroke(NO_STROKES, 'crown', LINE)
const trunk = withStroke(crown, 'branch', LINE)
const two = withStroke(trunk, 'branch', [...LINE])
const state = (change: Partial<State>): State => ({ ...EMPTY, ...change })
const said = (change: Partial<State>) => hintOf(state(change), 'mouse').text
const traced = (of: typeof two, ...warnings: StrokeWarning[]) => ({
  of,
  answer: { warnings } as unknown as TraceAnswer,
})
const JOINED = { code: 'branch_joined', stroke: 'branches/1', detail: 'it starts 80 px away' }

test('the hints lead from the crown to the trunk to the tree', () => {
  expect(said({})).toBe(text.hints.crown)
  expect(said({ tool: 'branch', history: begin(crown) })).toBe(text.hints.trunk)
  expect(said({ tool: 'branch', history: begin(trunk) })).toBe(text.hints.waiting)
  expect(said({ tool: 'branch', history: begin(trunk), liveTree: grown() })).toBe(text.hints.refine)
  expect(said({ tool: 'branch', history: begin(trunk), model: shownModel({ status: 'running' }) })).toBe(
    text.hints.growing,
  )
})

test('the finished tree is announced until the strokes change', () => {
  const model = shownModel({ status: 'succeeded' }, { strokes: trunk })
  const done = { tool: 'branch', liveTree: grown(), model } as const
  expect(said({ ...done, history: begin(trunk) })).toBe(text.hints.done)
  expect(said({ ...done, history: begin(two) })).toBe(text.hints.refine)
  const viewer = session({ member: { ...BO, role: 'viewer' } })
  expect(said({ ...done, history: begin(trunk), session: viewer })).toBe(text.hints.shown)
})

test('with another tool chosen the right one is named', () => {
  expect(said({ tool: 'branch' })).toBe(text.hints.chooseCrown)
  expect(said({ tool: 'select', history: begin(crown) })).toBe(text.hints.chooseBranch)
})

test('the gesture is that of the pointer in use', () => {
  expect(hintOf(EMPTY, 'mouse').how).toBe(text.hints.how.mouse.crown)
  expect(hintOf(EMPTY, 'touch').how).toBe(text.hints.how.touch.crown)
})

test('a fault of the strokes comes before everything and names the stroke to delete', () => {
  const stroke = { kind: 'branch', index: 0 } as const
  const faults = { strokes: { text: 'Too short.', stroke } }
  expect(hintOf(state({ online: false, faults }), 'mouse')).toEqual({ tone: 'fault', text: 'Too short.', stroke })
})

test('a lost connection is said', () => {
  expect(said({ online: false })).toBe(text.hints.offline)
})

test('a warning about the stroke just drawn is said with the next step', () => {
  const history = advance(begin(trunk), two)
  const hint = hintOf(state({ tool: 'branch', history, traced: traced(two, JOINED) }), 'mouse')
  expect(hint).toEqual({ tone: 'note', text: 'Branch 2: joined to the nearest branch.', how: text.hints.waiting })
})

test('a warning about an older stroke is not said again', () => {
  const three = withStroke(two, 'branch', [...LINE])
  const history = advance(begin(two), three)
  expect(said({ tool: 'branch', history, traced: traced(three, JOINED) })).toBe(text.hints.waiting)
})

test('a warning that the page does not know is said in the service’s words', () => {
  const history = advance(begin(trunk), two)
  const unknown = { code: 'new', stroke: 'branches/1', detail: 'it is odd' }
  expect(said({ tool: 'branch', history, traced: traced(two, unknown) })).toBe('Branch 2: it is odd')
})

test('a doubt about a stroke is said until it is drawn again, whatever was drawn since', () => {
  const unclear = { code: 'crown_unclear', stroke: 'crown', detail: 'it looks like its background' }
  const outside = { code: 'outside_photo', stroke: 'crown', detail: '40% of it lies outside' }
  const history = advance(begin(trunk), two)
  expect(said({ tool: 'branch', history, traced: traced(two, JOINED, unclear) })).toBe(text.hints.doubts.crown_unclear)
  expect(said({ tool: 'branch', history, traced: traced(two, outside) })).toContain(
    'Crown: much of it is outside the photo.',
  )
  expect(said({ tool: 'branch', history, traced: traced(trunk, unclear) })).toBe(text.hints.waiting)
})

test('what is selected can be deleted from the line', () => {
  const selection = { kind: 'crown', index: 0 } as const
  expect(hintOf(state({ history: begin(two), selection }), 'mouse')).toMatchObject({
    text: 'Selected: Crown',
    deletes: true,
  })
})

test('the measuring tool says what to measure, and the line asks for its length', () => {
  expect(said({ tool: 'scale' })).toBe(text.hints.measure)
  const selection = { kind: 'scale', index: 0 } as const
  expect(hintOf(state({ tool: 'scale', selection }), 'mouse')).toEqual({
    tone: 'step',
    text: text.hints.measured,
  })
})

test('on paper it goes from the trunk to the branches, to the other side, and on', () => {
  const { hints } = text.sheets
  const [bare, limbed] = [withStroke(NO_STROKES, 'branch', LINE), withStroke(trunk, 'branch', LINE)]
  const drawing = (present: typeof two, change: Partial<State> = {}) =>
    said({ sheets: sketchSheets(paper(), paper()), tool: 'branch', history: begin(present), ...change })
  expect(drawing(NO_STROKES)).toBe(hints.trunk)
  expect(drawing(NO_STROKES, { tool: 'crown' })).toBe(hints.chooseBranch)
  expect(drawing(limbed)).toBe(hints.side)
  expect(drawing(limbed, { active: 'side' })).toBe(hints.sideTrunk)
  expect(drawing(withSheet(limbed, 'side', bare), { active: 'side' })).toBe(hints.branches)
  expect(drawing(withSheet(limbed, 'side', limbed), { liveTree: grown() })).toBe(hints.refine)
})

test('beside a photo the side’s sheet says what it is for', () => {
  const { hints } = text.sheets
  const beside = (present: typeof two) =>
    said({ sheets: photoSheets(photo(), paper()), active: 'side', tool: 'branch', history: begin(present) })
  expect(beside(two)).toBe(hints.mixed)
  expect(beside(withSheet(two, 'side', two))).toBe(hints.mixedGrow)
})

test('what was corrected while a drawing was read is said until it is drawn on', () => {
  const corrections = { of: trunk, text: 'Front: 1 gap was closed.' }
  expect(hintOf(state({ tool: 'branch', history: begin(trunk), corrections }), 'mouse')).toEqual({
    tone: 'note',
    text: corrections.text,
    how: text.hints.waiting,
  })
  expect(said({ tool: 'branch', history: begin(two), corrections })).toBe(text.hints.waiting)
})

test('over many photos the hints lead on to the cameras, the tree and the other photos', () => {
  const { hints } = text.capture
  const [sheets, cameras] = [captureSheets(), [camera('00.jpg')]]
  const over = (strokes: typeof two, photo = '00.jpg') => begin(withPhoto(NO_STROKES, photo, strokes))
  expect(said({ sheets })).toBe(text.hints.crown)
  expect(said({ sheets, tool: 'branch', history: over(crown) })).toBe(text.hints.trunk)
  const drawn = { tool: 'branch', history: over(trunk) } as const
  expect(said({ sheets, ...drawn, sending: true })).toBe(hints.waiting)
  expect(said({ sheets, ...drawn })).toBe(hints.unsolved)
  const solved = { ...drawn, sheets: captureSheets(['00.jpg', '01.jpg'], { cameras }) }
  expect(said(solved)).toBe(hints.reading)
  const found = { of: drawn.history.present, answer: captureAnswer() }
  expect(said({ ...solved, traced: found, liveTree: grown() })).toBe(hints.refine)
})

test('over many photos it says which strokes do not count yet, and which photo is not used', () => {
  const { hints } = text.capture
  const branch = withStroke(NO_STROKES, 'branch', LINE)
  const history = begin(withPhoto(withPhoto(NO_STROKES, '01.jpg', trunk), '00.jpg', branch))
  expect(said({ sheets: captureSheets(), history })).toBe(hints.crownMissing)
  const photos = [capturePhoto('00.jpg', { used: false })]
  const drawn = begin(withPhoto(NO_STROKES, '01.jpg', trunk))
  expect(said({ sheets: captureSheets(['00.jpg'], { photos }), history: drawn })).toBe(hints.notUsed)
})
