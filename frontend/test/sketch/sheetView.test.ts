import { expect, test } from 'vitest'
import { begin } from '../../src/history'
import { paper } from '../../src/sheets'
import { extentOf, ofSheet, sightOf } from '../../src/sketch/sheetView'
import { EMPTY, type State } from '../../src/state'
import { NO_STROKES, withSheet, withStroke } from '../../src/strokes'
import { answer, CROWN, LIMB, photo, TRUNK } from '../builders'

const front = withStroke(NO_STROKES, 'branch', TRUNK)
const both = withSheet(front, 'side', withStroke(NO_STROKES, 'branch', LIMB))
const sketched: State = { ...EMPTY, source: 'sketch', photo: paper(), side: paper(), history: begin(both) }
const traced = { of: both, answer: answer(), crowns: { front: CROWN, side: CROWN } }

test('each sheet shows its own strokes, and what is selected or at fault on it', () => {
  const state: State = {
    ...sketched,
    selection: { kind: 'branch', index: 0, sheet: 'side' },
    faults: { strokes: { text: '', stroke: { kind: 'branch', index: 0 } } },
  }
  const [ahead, side] = [sightOf(state, 'front'), sightOf(state, 'side')]
  expect([ahead.strokes.branches, side.strokes.branches]).toEqual([[{ points: TRUNK }], [{ points: LIMB }]])
  expect([ahead.selection, side.selection]).toEqual([null, { kind: 'branch', index: 0 }])
  expect([ahead.fault, side.fault]).toEqual([{ kind: 'branch', index: 0 }, null])
})

test('paper shows the crown that was taken while none is drawn, and never what is traced in photos', () => {
  expect(sightOf({ ...sketched, traced }, 'side')).toMatchObject({ crown: CROWN, traced: null })
  const crowned = withSheet(both, 'side', { ...NO_STROKES, crown: CROWN, branches: [{ points: LIMB }] })
  expect(sightOf({ ...sketched, history: begin(crowned), traced }, 'side').crown).toBeNull()
})

test('a photo shows what is traced, no brush and no lines, until the side’s sheet is opened beside it', () => {
  const crowned = { ...front, crown: CROWN }
  const state: State = { ...EMPTY, photo: photo(), history: begin(crowned), traced, brush: 0.02 }
  expect(sightOf(state, 'front')).toMatchObject({ traced: traced.answer, crown: null, brush: null, levels: null })
  expect(sightOf({ ...state, side: paper(100) }, 'front').levels).toEqual({ root: 95, top: 40 })
  expect(sightOf({ ...state, side: paper(100) }, 'side').brush).toBe(2)
})

test('nothing is measured on paper', () => {
  expect(sightOf({ ...sketched, tool: 'scale' }, 'front').tool).toBe('select')
  expect(sightOf({ ...EMPTY, photo: photo(), tool: 'scale' }, 'front').tool).toBe('scale')
})

test('the widest of the sheets says how much is seen of all', () => {
  const wide = { ...sketched, side: { ...paper(), width: 2400, height: 1200 } }
  expect(extentOf(wide, 'front')).toEqual({ width: 2400, height: 1200 })
  expect(extentOf({ ...wide, side: { ...paper(), width: 1200, height: 600 } }, 'side')).toEqual({
    width: 1200,
    height: 600,
  })
  expect(extentOf({ ...wide, side: null }, 'side')).toBeNull()
})

test('what is chosen on the side is named for all of the page', () => {
  expect(ofSheet({ kind: 'branch', index: 2 }, 'side')).toEqual({ kind: 'branch', index: 2, sheet: 'side' })
  expect(ofSheet({ kind: 'branch', index: 2 }, 'front')).toEqual({ kind: 'branch', index: 2 })
})
