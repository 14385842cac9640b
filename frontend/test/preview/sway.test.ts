import { AnimationClip, Bone, Group, QuaternionKeyframeTrack } from 'three'
import { beforeEach, expect, test } from 'vitest'
import { Sway } from '../../src/preview/sway'

const HALF = Math.SQRT1_2
let bone: Bone
let sway: Sway
const clip = (name: string, turn: readonly number[]) =>
  new AnimationClip(name, 2, [
    new QuaternionKeyframeTrack('branch_01.quaternion', [0, 1, 2], [0, 0, 0, 1, ...turn, 0, 0, 0, 1]),
  ])

beforeEach(() => {
  bone = new Bone()
  bone.name = 'branch_01'
  const tree = new Group().add(bone)
  sway = new Sway(tree, [clip('breeze', [0, 0, HALF, HALF]), clip('measured', [HALF, 0, 0, HALF])])
})

test('a still tree does not move, and one that plays is at its place', () => {
  expect([sway.show(1, 0.1), bone.quaternion.z]).toEqual([false, 0])
  sway.choose('breeze', false)
  expect(sway.show(1, 0.1)).toBe(true)
  expect(bone.quaternion.z).toBeCloseTo(HALF, 6)
  sway.show(2, 0.1)
  expect(bone.quaternion.z).toBeCloseTo(0, 6)
})

test('what was measured comes first, and tells how long it is', () => {
  expect(sway.animations).toEqual(['measured', 'breeze'])
  expect([sway.lengthOf('measured'), sway.lengthOf('storm')]).toEqual([2, 0])
})

test('nothing moves while the place stays', () => {
  sway.choose('breeze', false)
  expect([sway.show(1, 0.1), sway.show(1, 0.1), sway.show(0.5, 0.1)]).toEqual([true, false, true])
})

test('without an animation the tree stands as it was', () => {
  sway.choose('breeze', false)
  sway.show(1, 0.1)
  sway.choose(null, true)
  expect([sway.show(0.5, 0.1), bone.quaternion.toArray()]).toEqual([false, [0, 0, 0, 1]])
})

test('one animation changes to another gradually, and back at once', () => {
  sway.choose('breeze', false)
  sway.show(1, 0.1)
  sway.choose('measured', true)
  sway.show(1, 0.3)
  expect(bone.quaternion.x).toBeGreaterThan(0.1)
  expect(bone.quaternion.z).toBeGreaterThan(0.1)
  sway.show(1, 0.4)
  expect(bone.quaternion.x).toBeCloseTo(HALF, 6)
  sway.choose('breeze', false)
  sway.show(1, 0.1)
  expect(bone.quaternion.z).toBeCloseTo(HALF, 6)
})

test('an animation that the file does not have moves nothing', () => {
  sway.choose('storm', false)
  expect(sway.show(1, 0.1)).toBe(false)
})

test('a gain changes how far a branch turns from its mean, and one brings it back', () => {
  const angle = () => (2 * Math.asin(bone.quaternion.z) * 180) / Math.PI
  sway.choose('breeze', false)
  sway.show(1, 0.1)
  const own = angle()
  sway.setGain(0)
  expect(sway.show(1, 0.1)).toBe(true)
  const mean = angle()
  expect([mean > 20, mean < 40]).toEqual([true, true])
  sway.setGain(1.5)
  sway.show(1, 0.1)
  expect(angle() - mean).toBeCloseTo(1.5 * (own - mean), 3)
  sway.setGain(1)
  sway.show(1, 0.1)
  expect(angle()).toBeCloseTo(own, 3)
})
