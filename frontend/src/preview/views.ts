import { type Pose, photoPose, treePose, type Viewport } from './camera'
import type { Content } from './content'
import type { View } from './status'

/** Azimuth and polar angle, radians. */
const DIRECTIONS: Record<Exclude<View, 'photo'>, [number, number]> = {
  front: [0, 1.44],
  side: [Math.PI / 2, 1.44],
  back: [Math.PI, 1.44],
  top: [0, 0.03],
}
const OPENING = [0.62, 1.33] as const

type Tree = Pick<Content, 'photo' | 'box'>

/** Return the pose of a named view of a tree, in this viewport. */
export function poseOf(name: View, { photo, box }: Tree, viewport: Viewport): Pose {
  return name === 'photo'
    ? photoPose(photo, aspectOf(viewport))
    : treePose(box, ...DIRECTIONS[name], aspectOf(viewport))
}

/** Return the pose in which the first tree is shown: a little from the side, so that its depth is visible. */
export function openingPose({ box }: Tree, viewport: Viewport): Pose {
  return treePose(box, ...OPENING, aspectOf(viewport))
}

/** Return width / height; 1 for a viewport that has no size yet. */
export function aspectOf({ width, height }: Viewport): number {
  return width > 0 && height > 0 ? width / height : 1
}
