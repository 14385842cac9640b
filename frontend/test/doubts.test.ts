import { expect, test } from 'vitest'
import type { StrokeWarning } from '../src/api/types'
import { doubtIn, remarksOn } from '../src/doubts'
import { begin } from '../src/history'
import { viewOf } from '../src/sketch/sheetView'
import { EMPTY, type State } from '../src/state'
import { NO_STROKES, withStroke } from '../src/strokes'
import { answer, CROWN, photoSheets, TRUNK } from './builders'

const drawn = withStroke(withStroke(NO_STROKES, 'crown', CROWN), 'branch', TRUNK)
const OUTSIDE = { code: 'outside_photo', stroke: 'branches/0', detail: '40% of it lies outside' }
const JOINED = { code: 'branch_joined', stroke: 'branches/1', detail: 'it was joined' }
const stateWith = (...warnings: StrokeWarning[]): State => ({
  ...EMPTY,
  sheets: photoSheets(),
  history: begin(drawn),
  traced: { of: drawn, answer: { ...answer(), warnings } },
})

test('a remark names its stroke', () => {
  expect(remarksOn(stateWith(JOINED, OUTSIDE)).map(({ stroke }) => stroke)).toEqual([
    { kind: 'branch', index: 1 },
    { kind: 'branch', index: 0 },
  ])
})

test('a correction is no doubt, and doubts about earlier strokes are gone', () => {
  expect(doubtIn(stateWith(JOINED, OUTSIDE))?.warning).toBe(OUTSIDE)
  expect(doubtIn(stateWith(JOINED))).toBeNull()
  expect(doubtIn({ ...stateWith(OUTSIDE), history: begin(NO_STROKES) })).toBeNull()
})

test('the stroke in doubt is marked on its sheet', () => {
  expect(viewOf(stateWith(OUTSIDE), 'front').fault).toEqual({ kind: 'branch', index: 0 })
  expect(viewOf(stateWith(JOINED), 'front').fault).toBeNull()
})
