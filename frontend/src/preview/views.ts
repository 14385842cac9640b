import { type Box, type Pose, treePose, type Viewport } from './camera'
import type { View } from './status'

/** Azimuth and polar angle, radians. */
const DIRECTIONS: Record<Exclude<View, 'photo'>, [number, number]> = {
  front: [0, 1.44],
  side: [Math.PI / 2, 1.44],
  back: [Math.PI, 1.44],
  top: [0, 0.03],
}
/** A little from the side, so that depth is visible; from higher up where there are cameras around. */
const OPENING: readonly [number, number] = [0.62, 1.33]
const OPENING_ON_CAMERAS: readonly [number, number] = [0.62, 1.12]

/** Return the pose of a named view of a tree, in this viewport. */
export function poseOf(name: Exclude<View, 'photo'>, box: Box, viewport: Viewport): Pose {
  return treePose(box, ...DIRECTIONS[name], aspectOf(viewport))
}

/** Return the pose in which the first tree is shown, or cameras where there is no tree yet. */
export function openingPose(box: Box, viewport: Viewport, ofCameras: boolean): Pose {
  return treePose(box, ...(ofCameras ? OPENING_ON_CAMERAS : OPENING), aspectOf(viewport))
}

/** Return width / height; 1 for a viewport that has no size yet. */
export function aspectOf({ width, height }: Viewport): number {
  return width > 0 && height > 0 ? width / height : 1
}
