import { expect, test } from 'vitest'
import { begin } from '../src/history'
import { brushWidth, commonLevels, differingLevels, fittedTo, isDrawn, isPaper, levelsOf, paper } from '../src/sheets'
import { EMPTY, type State } from '../src/state'
import { type Line, NO_STROKES, type Strokes, withSheet, withStroke } from '../src/strokes'
import { photo, photoSheets, sketchSheets } from './builders'

const up = (root: number, top: number): Line => [
  [450, root],
  [450, top],
]
const trunk = (root: number, top: number) => withStroke(NO_STROKES, 'branch', up(root, top))
const both = (front: Strokes, side: Strokes) => withSheet(front, 'side', side)
const state = (present: Strokes, changes: Partial<State> = {}): State => ({
  ...EMPTY,
  ...{ sheets: sketchSheets(paper(), paper()), history: begin(present) },
  ...changes,
})

test('paper is upright, and as high as the sheet that it lies beside', () => {
  expect(paper()).toMatchObject({ width: 900, height: 1200, id: null, url: null })
  expect(paper(600)).toMatchObject({ width: 450, height: 600 })
})

test('every sheet is paper but the photo whose tree is traced', () => {
  expect(isPaper({ sheets: photoSheets() }, 'front')).toBe(false)
  expect(isPaper({ sheets: photoSheets() }, 'side')).toBe(true)
  expect(isPaper({ sheets: sketchSheets(paper()) }, 'front')).toBe(true)
})

test('a tree’s levels are the foot of its trunk and its topmost stroke, whichever way the trunk was drawn', () => {
  const limb = withStroke(trunk(1100, 300), 'branch', up(500, 120))
  expect(levelsOf(limb)).toEqual({ root: 1100, top: 120 })
  expect(levelsOf(trunk(300, 1100))).toEqual({ root: 1100, top: 300 })
  expect(levelsOf(NO_STROKES)).toBeNull()
})

test('both sheets have the same levels: where a tree is expected, then those of the front’s tree', () => {
  expect(commonLevels(state(NO_STROKES), 'side')).toEqual({ root: 1104, top: 96 })
  const drawn = state(trunk(1000, 200), { sheets: sketchSheets(paper(), paper(600)) })
  expect(commonLevels(drawn, 'front')).toEqual({ root: 1000, top: 200 })
  expect(commonLevels(drawn, 'side')).toEqual({ root: 500, top: 100 })
  expect(commonLevels({ ...drawn, sheets: sketchSheets(paper()) }, 'side')).toBeNull()
})

test('a side of another height has levels of its own, one of the same height none', () => {
  expect(differingLevels(state(both(trunk(1100, 100), trunk(1110, 90))))).toBeNull()
  expect(differingLevels(state(both(trunk(1100, 100), trunk(1100, 300))))).toEqual({ root: 1100, top: 300 })
  expect(differingLevels(state(trunk(1100, 100)))).toBeNull()
})

test('a drawing that is fitted to another sheet keeps its shape, and its brushes are scaled with it', () => {
  const drawn = withStroke(NO_STROKES, 'branch', up(1200, 0), 12)
  const { branches } = fittedTo(drawn, paper(), { width: 800, height: 600 })
  expect(branches).toEqual([
    {
      points: [
        [400, 600],
        [400, 0],
      ],
      width: 6,
    },
  ])
})

test('a brush’s width is a share of the paper’s height, a pencil has no width', () => {
  expect(brushWidth({ brush: 0.018 }, { width: 900, height: 1200 })).toBe(21.6)
  expect(brushWidth({ brush: null }, photo())).toBeNull()
})

test('a sheet is drawn on once it has a stroke', () => {
  const drawn = both(NO_STROKES, trunk(9, 1))
  expect([isDrawn(drawn, 'front'), isDrawn(drawn, 'side')]).toEqual([false, true])
})
