import { expect, test } from 'vitest'
import { begin } from '../../src/history'
import { paper, sheetOfSize } from '../../src/sheets'
import { extentOf, toPageSelection, viewOf } from '../../src/sketch/sheetView'
import { EMPTY, type Sheet, type State } from '../../src/state'
import { NO_STROKES, withSheet, withStroke } from '../../src/strokes'
import { answer, CROWN, captureSheets, LIMB, photoSheets, sketchSheets, TRUNK } from '../builders'

const front = withStroke(NO_STROKES, 'branch', TRUNK)
const both = withSheet(front, 'side', withStroke(NO_STROKES, 'branch', LIMB))
const sketched: State = { ...EMPTY, sheets: sketchSheets(paper(), paper()), history: begin(both) }
const traced = { of: both, answer: answer(), crowns: { front: CROWN, side: CROWN } }

test('each sheet shows its own strokes, and its own selection and fault', () => {
  const state: State = {
    ...sketched,
    selection: { kind: 'branch', index: 0, sheet: 'side' },
    faults: { strokes: { text: '', stroke: { kind: 'branch', index: 0 } } },
  }
  const [ahead, side] = [viewOf(state, 'front'), viewOf(state, 'side')]
  expect([ahead.strokes.branches, side.strokes.branches]).toEqual([[{ points: TRUNK }], [{ points: LIMB }]])
  expect([ahead.selection, side.selection]).toEqual([null, { kind: 'branch', index: 0 }])
  expect([ahead.fault, side.fault]).toEqual([{ kind: 'branch', index: 0 }, null])
})

test('paper shows the assumed crown while none is drawn, and never what is traced in photos', () => {
  expect(viewOf({ ...sketched, traced }, 'side')).toMatchObject({ assumedCrown: CROWN, traced: null })
  const crowned = withSheet(both, 'side', { ...NO_STROKES, crown: CROWN, branches: [{ points: LIMB }] })
  expect(viewOf({ ...sketched, history: begin(crowned), traced }, 'side').assumedCrown).toBeNull()
})

test('a photo shows what is traced, no brush and no lines, until the side’s sheet is opened beside it', () => {
  const crowned = { ...front, crown: CROWN }
  const state: State = { ...EMPTY, sheets: photoSheets(), history: begin(crowned), traced, brush: 0.02 }
  expect(viewOf(state, 'front')).toMatchObject({ traced: traced.answer, assumedCrown: null, brush: null, levels: null })
  const beside = { ...state, sheets: photoSheets(undefined, paper(100)) }
  expect(viewOf(beside, 'front').levels).toEqual({ root: 95, top: 40 })
  expect(viewOf(beside, 'side').brush).toBe(2)
})

test('the scale tool is not used on paper', () => {
  expect(viewOf({ ...sketched, tool: 'scale' }, 'front').tool).toBe('select')
  expect(viewOf({ ...EMPTY, sheets: photoSheets(), tool: 'scale' }, 'front').tool).toBe('scale')
})

test('the widest sheet sets the extent of all', () => {
  const beside = (side: Sheet | null) => ({ ...sketched, sheets: sketchSheets(paper(), side) })
  const [wide, small] = [
    { width: 2400, height: 1200 },
    { width: 1200, height: 600 },
  ]
  expect(extentOf(beside(sheetOfSize(wide)), 'front')).toEqual(wide)
  expect(extentOf(beside(sheetOfSize(small)), 'side')).toEqual(small)
  expect(extentOf(beside(null), 'side')).toBeNull()
})

test('what is selected on the side keeps its sheet’s name in the page’s state', () => {
  expect(toPageSelection({ kind: 'branch', index: 2 }, 'side', null)).toEqual({
    kind: 'branch',
    index: 2,
    sheet: 'side',
  })
  expect(toPageSelection({ kind: 'branch', index: 2 }, 'front', null)).toEqual({ kind: 'branch', index: 2 })
})

test('what is selected over one photo of many keeps its photo in the page’s state', () => {
  const selected = toPageSelection({ kind: 'crown', index: 0 }, 'front', '03.jpg')
  expect(selected).toEqual({ kind: 'crown', index: 0, photo: '03.jpg' })
  const state = { ...EMPTY, sheets: captureSheets(), selection: selected }
  expect(viewOf(state, 'front').selection).toBeNull()
  expect(viewOf({ ...state, sheets: captureSheets(['03.jpg']) }, 'front').selection).toEqual({
    kind: 'crown',
    index: 0,
  })
})
