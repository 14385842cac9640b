import { AnimationClip, Bone, Group, QuaternionKeyframeTrack } from 'three'
import { expect, test } from 'vitest'
import { Playhead } from '../../src/playhead'
import { Motion } from '../../src/preview/motion'
import { Sway } from '../../src/preview/sway'

const TURN = new QuaternionKeyframeTrack('branch.quaternion', [0, 1, 2], [0, 0, 0, 1, 0, 0, 1, 0, 0, 0, 0, 1])

function tree(...names: string[]) {
  const bone = new Bone()
  bone.name = 'branch'
  const sway = new Sway(
    new Group().add(bone),
    names.map(name => new AnimationClip(name, 2, [TURN])),
  )
  return { sway, motion: { frames: 45, frames_per_second: 30 } }
}

function moved(isCalm: boolean, ...names: string[]) {
  const playhead = new Playhead(() => 0)
  const motion = new Motion(playhead, isCalm)
  motion.show(tree(...names))
  return { playhead, motion }
}

test('what was measured plays first, by the frames of its clip', () => {
  const { motion, playhead } = moved(false, 'breeze', 'measured')
  expect([motion.animation, playhead.playing]).toEqual(['measured', true])
  expect(playhead.span).toEqual({ seconds: 2, frames: 45, framesPerSecond: 30 })
})

test('without a video a breeze does', () => {
  const { motion, playhead } = moved(false, 'gust', 'breeze')
  expect([motion.animation, playhead.span]).toEqual(['breeze', { seconds: 2 }])
})

test('who wants no motion sees a tree that stands, or the first frame of what was measured', () => {
  expect(moved(true, 'breeze').motion.animation).toBeNull()
  const { motion, playhead } = moved(true, 'measured')
  expect([motion.animation, playhead.playing, motion.step(0.1), motion.step(0.1)]).toEqual([
    'measured',
    false,
    true,
    false,
  ])
})

test('what is asked for plays, and the next tree plays it too', () => {
  const { motion, playhead } = moved(true, 'breeze', 'gust')
  motion.choose('gust')
  expect([motion.animation, playhead.playing]).toEqual(['gust', true])
  motion.show(tree('measured', 'breeze', 'gust'))
  expect(motion.animation).toBe('gust')
  motion.choose(null)
  expect([motion.animation, playhead.span, motion.step(0.1)]).toEqual([null, null, false])
})

test('no tree plays nothing', () => {
  const { motion, playhead } = moved(false, 'measured')
  motion.show(null)
  expect([motion.animations, motion.animation, playhead.span]).toEqual([[], null, null])
})
