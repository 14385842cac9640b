import { expect, test } from 'vitest'
import { NO_STROKES } from '../../src/strokes'
import { sketchIn } from '../../src/studio/sketchPicture'
import { CROWN, drawnAnswer, TRUNK } from '../builders'

const SHOWN = drawnAnswer().front

/** A trunk that bears so many limbs, each a little longer than the one before, and a twig on the first of them. */
function bearing(limbs: number) {
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

test('every branch is one stroke, the trunk first, each from the line of its bearer to its tip', () => {
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

test('a stroke is as wide as its brush mostly was', () => {
  expect(sketchIn(SHOWN).strokes.branches.map(({ width }) => width)).toEqual([10, 4])
})

test('a pen’s strokes have no width', () => {
  const radii = SHOWN.skeleton.radii.map(() => 0)
  const { branches } = sketchIn({ ...SHOWN, skeleton: { ...SHOWN.skeleton, radii } }).strokes
  expect(branches.every(branch => !('width' in branch))).toBe(true)
})

test('a crown that was drawn is the crown, one that was assumed is none', () => {
  const crown = CROWN.map(([x, y]) => [x, y] as [number, number])
  expect(sketchIn({ ...SHOWN, crown, crown_drawn: true }).strokes.crown).toEqual(CROWN)
  expect(sketchIn({ ...SHOWN, crown }).strokes).toMatchObject({ ...NO_STROKES, branches: expect.anything() })
})

test('of more branches than can be drawn the shortest are left out, those that bear others last, and it is said', () => {
  const size: [number, number] = [1000, 1000]
  const { strokes, corrections } = sketchIn({ ...SHOWN, skeleton: bearing(210), size })
  expect(strokes.branches).toHaveLength(199)
  expect(corrections).toContain('13 shortest branches were left out')
  expect(strokes.branches[0]!.points[0]).toEqual([500, 1000])
  expect(strokes.branches.at(-1)!.points).toEqual([
    [510, 100],
    [510, 800],
  ])
  expect(strokes.branches[1]!.points.at(-1)).toEqual([510, 100])
})

test('what was mended is said once for each kind', () => {
  const told = (code: string, detail = '') => ({ code, stroke: 'front/picture', detail })
  const warnings = [told('loop_cut'), told('branch_joined'), told('loop_cut'), told('new_one', 'a dot was dropped')]
  const { corrections } = sketchIn(SHOWN, warnings)
  expect(corrections).toMatch(/^2 rings of branches were cut open\. a gap was bridged\. A dot was dropped\.$/)
  expect(sketchIn(SHOWN).corrections).toBeUndefined()
})
