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
  sway = new Sway(tree, [clip('breeze', [0, 0, HALF, HALF]), clip('gust', [HALF, 0, 0, HALF])])
})

test('a still tree does not move, and one in the wind does', () => {
  expect(sway.winds).toEqual(['breeze', 'gust'])
  expect([sway.step(1), bone.quaternion.z]).toEqual([false, 0])
  sway.setWind('breeze')
  expect(sway.step(1)).toBe(true)
  expect(bone.quaternion.z).toBeCloseTo(HALF, 6)
})

test('wind repeats', () => {
  sway.setWind('breeze')
  sway.step(1)
  sway.step(2)
  expect(bone.quaternion.z).toBeCloseTo(HALF, 6)
})

test('without wind the tree stands as it was', () => {
  sway.setWind('breeze')
  sway.step(1)
  sway.setWind(null)
  expect([sway.step(0.1), bone.quaternion.toArray()]).toEqual([false, [0, 0, 0, 1]])
})

test('one wind changes to another, and back', () => {
  sway.setWind('breeze')
  sway.step(1)
  sway.setWind('gust')
  sway.step(0.7)
  sway.step(0.3)
  expect(bone.quaternion.x).toBeCloseTo(HALF, 6)
  sway.setWind('breeze')
  sway.step(0.7)
  sway.step(0.3)
  expect(bone.quaternion.z).toBeCloseTo(HALF, 6)
})

test('a wind that the file does not have moves nothing', () => {
  sway.setWind('storm')
  expect(sway.step(1)).toBe(false)
})
