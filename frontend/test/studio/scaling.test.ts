import { expect, test } from 'vitest'
import { begin } from '../../src/history'
import { EMPTY, type State } from '../../src/state'
import type { Line, Strokes } from '../../src/strokes'
import { metresOf } from '../../src/studio/scaling'
import { CROWN, TRUNK } from '../builders'

const LINE: Line = [
  [10, 60],
  [10, 77],
]
const drawn: Strokes = { crown: CROWN, branches: [{ points: TRUNK }], erase: [], scale: null }
const state = (strokes: Partial<Strokes>): State => ({ ...EMPTY, history: begin({ ...drawn, ...strokes }) })

test('a length is guessed from the tree’s height, from the trunk’s foot to the crown’s top', () => {
  expect(metresOf(LINE, state({}))).toBeCloseTo((17 / 85) * 10, 6)
})

test('a length is guessed from the line before it', () => {
  const scale = { points: [CROWN[0]!, [20, 20]] as Line, metres: 1.8 }
  expect(metresOf(LINE, state({ scale }))).toBeCloseTo(3.1, 6)
})

test('a line has a length even where nothing is drawn', () => {
  expect(metresOf(LINE, state({ crown: null, branches: [] }))).toBeGreaterThan(0)
})
