import { expect, test } from 'vitest'
import {
  fromWire,
  isEmpty,
  lineOf,
  NO_STROKES,
  onSheet,
  strokeAt,
  strokeRefs,
  toWire,
  withoutStroke,
  withSheet,
  withStroke,
} from '../src/strokes'
import { CROWN, LIMB, TRUNK } from './builders'

const RING = [
  [0, 0],
  [10, 0],
  [5, 8],
] as const
const UP = [
  [5, 20],
  [5, 9.25],
] as const

test('a second crown replaces the first', () => {
  const once = withStroke(NO_STROKES, 'crown', RING)
  expect(withStroke(once, 'crown', UP)).toEqual({ crown: UP, branches: [], erase: [], scale: null })
})

test('branches and erase strokes are added after those that are there', () => {
  const drawn = withStroke(withStroke(withStroke(NO_STROKES, 'branch', UP), 'branch', RING), 'erase', UP)
  expect(drawn).toEqual({ crown: null, branches: [{ points: UP }, { points: RING }], erase: [UP], scale: null })
})

test('an edit leaves the value before it as it was', () => {
  const before = withStroke(NO_STROKES, 'branch', UP)
  withStroke(before, 'branch', RING)
  withoutStroke(before, { kind: 'branch', index: 0 })
  expect(before).toEqual({ crown: null, branches: [{ points: UP }], erase: [], scale: null })
  expect(isEmpty(NO_STROKES)).toBe(true)
})

test('every stroke can be removed by its reference, and only that one', () => {
  const drawn = {
    crown: RING,
    branches: [{ points: UP }, { points: RING }],
    erase: [UP, RING],
    scale: { points: UP, metres: 2 },
  }
  for (const ref of strokeRefs(drawn)) {
    const left = withoutStroke(drawn, ref)
    expect(strokeRefs(left)).toHaveLength(5)
    expect(strokeRefs(left).filter(other => other.kind !== ref.kind)).toEqual(
      strokeRefs(drawn).filter(other => other.kind !== ref.kind),
    )
  }
  expect(withoutStroke(drawn, { kind: 'branch', index: 0 }).branches).toEqual([{ points: RING }])
})

test('a stroke that does not exist has no points', () => {
  expect(lineOf(NO_STROKES, { kind: 'crown', index: 0 })).toEqual([])
  expect(lineOf(NO_STROKES, { kind: 'branch', index: 3 })).toEqual([])
  expect(lineOf({ ...NO_STROKES, erase: [UP] }, { kind: 'erase', index: 0 })).toBe(UP)
})

test('without a crown none is written, and the rest is read back unchanged', () => {
  const drawn = withStroke(NO_STROKES, 'branch', UP)
  expect(toWire(drawn)).not.toHaveProperty('crown')
  expect(fromWire(JSON.parse(JSON.stringify(toWire(drawn))))).toEqual(drawn)
})

test('what is written for the service is read back unchanged', () => {
  const drawn = {
    crown: RING,
    branches: [{ points: UP, width: 12.5 }, { points: RING }],
    erase: [UP],
    scale: { points: UP, metres: 1.8 },
  }
  expect(fromWire(JSON.parse(JSON.stringify(toWire(drawn))))).toEqual(drawn)
})

test('a stroke file may leave everything out', () => {
  expect(fromWire({})).toEqual(NO_STROKES)
})

test.each(
  [
    null,
    [],
    'crown',
    { crown: [] },
    { crown: { points: 'none' } },
    { crown: { points: [[1]] } },
    { crown: { points: [[1, 2, 3]] } },
    { branches: [{ points: [[1, null]] }] },
    { branches: [{ points: [[1, '2']] }] },
    { erase: {} },
    { scale: {} },
    {
      scale: {
        points: [
          [0, 0],
          [1, 1],
        ],
      },
    },
    {
      scale: {
        points: [
          [0, 0],
          [1, 1],
        ],
        metres: 0,
      },
    },
    {
      scale: {
        points: [
          [0, 0],
          [1, 1],
          [2, 2],
        ],
        metres: 1,
      },
    },
  ].map(value => ({ value })),
)('another form is refused: $value', ({ value }) => {
  expect(() => fromWire(value)).toThrow(TypeError)
})

test('strokes of the side are referred to, found and removed apart from the front’s', () => {
  const front = withStroke(NO_STROKES, 'branch', LIMB)
  const both = withSheet(front, 'side', withStroke(withStroke(NO_STROKES, 'crown', CROWN), 'branch', TRUNK, 5))
  const ref = { kind: 'branch', index: 0, sheet: 'side' } as const
  expect(strokeRefs(both)).toEqual([{ kind: 'branch', index: 0 }, { kind: 'crown', index: 0, sheet: 'side' }, ref])
  expect(lineOf(both, ref)).toBe(TRUNK)
  expect(onSheet(both, 'front')).toEqual(front)
  expect(withoutStroke(both, ref).side).toEqual({ crown: CROWN, branches: [] })
  expect(withoutStroke(both, { kind: 'branch', index: 0 }).side).toBe(both.side)
  expect(isEmpty(withSheet(NO_STROKES, 'side', front))).toBe(false)
})

test.each([
  ['/crown', { kind: 'crown', index: 0 }],
  ['/branches/2', { kind: 'branch', index: 2 }],
  ['/branches/2/points/7', { kind: 'branch', index: 2 }],
  ['/strokes/erase/1', { kind: 'erase', index: 1 }],
  ['/strokes/scale/metres', { kind: 'scale', index: 0 }],
  ['/front/branches/2', { kind: 'branch', index: 2 }],
  ['/side/crown', { kind: 'crown', index: 0, sheet: 'side' }],
  ['/sketches/side/branches/1/points/3', { kind: 'branch', index: 1, sheet: 'side' }],
  ['/settings/height', null],
  [null, null],
])('the pointer %s refers to %o', (pointer, stroke) => {
  expect(strokeAt(pointer)).toEqual(stroke)
})
