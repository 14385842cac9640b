import { expect, test } from 'vitest'
import { NO_STROKES } from '../../src/strokes'
import { sketchIn } from '../../src/studio/sketchPicture'
import { CROWN, drawnAnswer, TRUNK } from '../builders'

const SHOWN = drawnAnswer().front

/** A trunk with this many limbs, each a little longer than the one before, and a twig on the first of them. */
function trunkWith(limbs: number) {
  const trunk = [0, 1].map(end => [500, 1000 - 900 * end] as [number, number])
  const tips = Array.from({ length: limbs }, (_, limb) => [510 + limb, 100] as [number, number])
  const twig: [number, number] = [510, 800]
  return {
    points: [...trunk, ...tips, twig],
    radii: Array.from({ length: limbs + 3 }, () => 0),
    parents: [-1, 0, ...tips.map(() => 1), 2],
    stroke: [0, 0, ...tips.map((_, limb) => limb + 1), limbs + 1],
  }
}

test('every branch is one stroke, the trunk first, each from the line of its parent branch to its tip', () => {
  const { strokes, size } = sketchIn(SHOWN)
  expect(strokes.branches.map(({ points }) => points)).toEqual([
    TRUNK,
    [
      [50, 70],
      [70, 50],
    ],
  ])
  expect(size).toEqual({ width: 100, height: 100 })
})

test('a stroke has the median width of its line', () => {
  expect(sketchIn(SHOWN).strokes.branches.map(({ width }) => width)).toEqual([10, 4])
})

test('a pen’s strokes have no width', () => {
  const radii = SHOWN.skeleton.radii.map(() => 0)
  const { branches } = sketchIn({ ...SHOWN, skeleton: { ...SHOWN.skeleton, radii } }).strokes
  expect(branches.every(branch => !('width' in branch))).toBe(true)
})

test('a crown that was drawn becomes a stroke, one that was assumed does not', () => {
  const crown = CROWN.map(([x, y]) => [x, y] as [number, number])
  expect(sketchIn({ ...SHOWN, crown, crown_drawn: true }).strokes.crown).toEqual(CROWN)
  expect(sketchIn({ ...SHOWN, crown }).strokes).toMatchObject({ ...NO_STROKES, branches: expect.anything() })
})

test('of too many branches the shortest are left out, parent branches last, and the corrections say so', () => {
  const size: [number, number] = [1000, 1000]
  const { strokes, corrections } = sketchIn({ ...SHOWN, skeleton: trunkWith(210), size })
  expect(strokes.branches).toHaveLength(199)
  expect(corrections).toContain('13 shortest branches were left out')
  expect(strokes.branches[0]!.points[0]).toEqual([500, 1000])
  expect(strokes.branches.at(-1)!.points).toEqual([
    [510, 100],
    [510, 800],
  ])
  expect(strokes.branches[1]!.points.at(-1)).toEqual([510, 100])
})

test('the corrections name each kind once', () => {
  const warning = (code: string, detail = '') => ({ code, stroke: 'front/picture', detail })
  const warnings = [
    warning('loop_cut'),
    warning('branch_joined'),
    warning('loop_cut'),
    warning('new_one', 'a dot was dropped'),
  ]
  const { corrections } = sketchIn(SHOWN, warnings)
  expect(corrections).toMatch(/^2 loops of branches were cut open\. 1 gap was closed\. A dot was dropped\.$/)
  expect(sketchIn(SHOWN).corrections).toBeUndefined()
})
