import { type Pose, photoPose, treePose, type Viewport } from './camera'
import type { Content } from './content'
import type { View } from './status'

/** Azimuth and polar angle, in radians. */
const DIRECTIONS: Record<Exclude<View, 'photo'>, [number, number]> = {
  front: [0, 1.44],
  side: [Math.PI / 2, 1.44],
  back: [Math.PI, 1.44],
  top: [0, 0.03],
}
const OPENING = [0.62, 1.33] as const

type Seen = Pick<Content, 'photo' | 'box'>

/** Where a view stands before this tree, in this room. */
export function poseOf(name: View, { photo, box }: Seen, room: Viewport): Pose {
  return name === 'photo' ? photoPose(photo, aspectOf(room)) : treePose(box, ...DIRECTIONS[name], aspectOf(room))
}

/** Where one stands before the first tree: a little to its side, so that it is seen to be round. */
export function openingPose({ box }: Seen, room: Viewport): Pose {
  return treePose(box, ...OPENING, aspectOf(room))
}

/** Width over height; 1 for what has no size yet. */
export function aspectOf({ width, height }: Viewport): number {
  return width > 0 && height > 0 ? width / height : 1
}
