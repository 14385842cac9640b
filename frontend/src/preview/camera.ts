import type { PhotoFrame } from '../api/types'

/** A point or direction in the preview's world: +Y up, +X photo right, +Z to the camera; 1 unit = the photo's height. */
export type Vec3 = readonly [number, number, number]
/** A box along the axes of the preview's world. */
export interface Box {
  min: Vec3
  max: Vec3
}
/** Size of the preview's element, CSS px. */
export interface Viewport {
  width: number
  height: number
}
/** A rectangle in the preview's element, CSS px. */
export interface Rect extends Viewport {
  x: number
  y: number
}
/**
 * Where the camera stands and looks: at `target`, from the direction `azimuth` (0 = the photo's side, turning to +X) and
 * `polar` (0 = above), radians; it sees a height of `size` world units at the target; `slope` is its lens, tan(fov / 2).
 */
export interface Pose {
  target: Vec3
  azimuth: number
  polar: number
  size: number
  slope: number
}

/** A lens so long that it matches the photo's orthographic view to a fraction of a pixel. */
export const PHOTO_SLOPE = Math.tan((0.1 * Math.PI) / 360)
/** The lens of every other view, 28 degrees. */
export const VIEW_SLOPE = Math.tan((28 * Math.PI) / 360)
/** The size of a view of the whole tree, as a multiple of the tree's. */
const MARGIN = 1.14

/** Return how many world units a metre has. */
export function unitsPerMetre(photo: PhotoFrame): number {
  return 1 / (photo.metres_per_pixel * photo.height)
}

/** Return the world point of a photo's pixel, in the vertical plane through the root. */
export function worldOfPixel(photo: PhotoFrame, x: number, y: number): Vec3 {
  return [(x - photo.root[0]) / photo.height, (photo.root[1] - y) / photo.height, 0]
}

/** Return the photo's own view: the whole photo, as large as fits a viewport of this aspect (width / height). */
export function photoPose(photo: PhotoFrame, aspect: number): Pose {
  const target = worldOfPixel(photo, photo.width / 2, photo.height / 2)
  const size = Math.max(1, photo.width / photo.height / aspect)
  return { target, azimuth: 0, polar: Math.PI / 2, size, slope: PHOTO_SLOPE }
}

/** Return a view of the whole tree from a direction, with a margin; the tree counts as the ellipsoid in its box. */
export function treePose(box: Box, azimuth: number, polar: number, aspect: number): Pose {
  const half = ([0, 1, 2] as const).map(axis => (box.max[axis] - box.min[axis]) / 2)
  const { right, up } = axes(azimuth, polar)
  const halfExtent = (along: Vec3) => Math.hypot(half[0]! * along[0], half[1]! * along[1], half[2]! * along[2])
  const size = 2 * MARGIN * Math.max(halfExtent(up), halfExtent(right) / aspect)
  const target: Vec3 = [(box.min[0] + box.max[0]) / 2, (box.min[1] + box.max[1]) / 2, (box.min[2] + box.max[2]) / 2]
  return { target, azimuth, polar, size, slope: VIEW_SLOPE }
}

/** Return the distance from the target to the camera, world units. */
export function distanceOf(pose: Pose): number {
  return pose.size / 2 / pose.slope
}

/** Return the camera's unit axes: right, up, and back (from the target to the camera). */
export function axes(azimuth: number, polar: number): { right: Vec3; up: Vec3; back: Vec3 } {
  const [sa, ca, sp, cp] = [Math.sin(azimuth), Math.cos(azimuth), Math.sin(polar), Math.cos(polar)]
  return { right: [ca, 0, -sa], up: [-sa * cp, sp, -ca * cp], back: [sa * sp, cp, ca * sp] }
}

/** Return the camera's position in the world. */
export function eyeOf(pose: Pose): Vec3 {
  const { back } = axes(pose.azimuth, pose.polar)
  const distance = distanceOf(pose)
  return [pose.target[0] + back[0] * distance, pose.target[1] + back[1] * distance, pose.target[2] + back[2] * distance]
}

/** Return where the camera shows a world point, CSS px from the viewport's top left corner, y down. */
export function screenOf(pose: Pose, point: Vec3, viewport: Viewport): [number, number] {
  const { right, up, back } = axes(pose.azimuth, pose.polar)
  const offset: Vec3 = [point[0] - pose.target[0], point[1] - pose.target[1], point[2] - pose.target[2]]
  const distance = distanceOf(pose)
  const scale = ((viewport.height / pose.size) * distance) / (distance - dot(back, offset))
  return [viewport.width / 2 + scale * dot(right, offset), viewport.height / 2 - scale * dot(up, offset)]
}

/** Return the photo's rectangle in the viewport, for a camera that faces it. */
export function photoRect(pose: Pose, photo: PhotoFrame, viewport: Viewport): Rect {
  const [x, y] = screenOf(pose, worldOfPixel(photo, 0, 0), viewport)
  const height = viewport.height / pose.size
  return { x, y, width: (height * photo.width) / photo.height, height }
}

/** Return distances of the near and far planes that include all within `radius` world units of the target. */
export function depthRange(pose: Pose, radius: number): [number, number] {
  const distance = distanceOf(pose)
  return [Math.max(distance - radius, 0.02), distance + radius]
}

/** Return the pose at `t` (0..1) of a flight: it turns the shorter way, and its lens changes evenly. */
export function interpolate(from: Pose, to: Pose, t: number): Pose {
  const mix = (a: number, b: number) => a + (b - a) * t
  const turn = Math.atan2(Math.sin(to.azimuth - from.azimuth), Math.cos(to.azimuth - from.azimuth))
  return {
    target: [mix(from.target[0], to.target[0]), mix(from.target[1], to.target[1]), mix(from.target[2], to.target[2])],
    azimuth: from.azimuth + turn * t,
    polar: mix(from.polar, to.polar),
    size: Math.exp(mix(Math.log(from.size), Math.log(to.size))),
    slope: mix(from.slope, to.slope),
  }
}

/** Return a pose for a viewport of another aspect: it shows as much across the narrower side as before. */
export function refit(pose: Pose, was: number, now: number): Pose {
  return { ...pose, size: (pose.size * Math.min(1, was)) / Math.min(1, now) }
}

function dot(a: Vec3, b: Vec3): number {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/** Return the horizon's height in the viewport, -1 (bottom) to 1 (top); in the photo's view, that of the tree's root. */
export function horizonOf(pose: Pose): number {
  const distance = (40 * pose.slope) / VIEW_SLOPE
  const farGround: Vec3 = [
    pose.target[0] - distance * Math.sin(pose.azimuth),
    0,
    pose.target[2] - distance * Math.cos(pose.azimuth),
  ]
  return 1 - screenOf(pose, farGround, { width: 2, height: 2 })[1]
}
