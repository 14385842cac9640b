import { expect, test } from 'vitest'
import type { StrokeWarning } from '../src/api/types'
import { doubtIn, remarksOn } from '../src/doubts'
import { begin } from '../src/history'
import { viewOf } from '../src/sketch/sheetView'
import { EMPTY, type State } from '../src/state'
import { NO_STROKES, withStroke } from '../src/strokes'
import { answer, CROWN, photoSheets, TRUNK } from './builders'

const drawn = withStroke(withStroke(NO_STROKES, 'crown', CROWN), 'branch', TRUNK)
const LEVEL = { code: 'trunk_level', stroke: 'branches/0', detail: 'it lies level' }
const JOINED = { code: 'branch_joined', stroke: 'branches/1', detail: 'it was joined' }
const told = (...warnings: StrokeWarning[]): State => ({
  ...EMPTY,
  sheets: photoSheets(),
  history: begin(drawn),
  traced: { of: drawn, answer: { ...answer(), warnings } },
})

test('a remark names the stroke that it is about', () => {
  expect(remarksOn(told(JOINED, LEVEL)).map(({ stroke }) => stroke)).toEqual([
    { kind: 'branch', index: 1 },
    { kind: 'branch', index: 0 },
  ])
})

test('what is mended is no doubt, and one about other strokes is gone', () => {
  expect(doubtIn(told(JOINED, LEVEL))?.warning).toBe(LEVEL)
  expect(doubtIn(told(JOINED))).toBeNull()
  expect(doubtIn({ ...told(LEVEL), history: begin(NO_STROKES) })).toBeNull()
})

test('the stroke in doubt is marked on its sheet', () => {
  expect(viewOf(told(LEVEL), 'front').fault).toEqual({ kind: 'branch', index: 0 })
  expect(viewOf(told(JOINED), 'front').fault).toBeNull()
})
