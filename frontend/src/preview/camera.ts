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
 * `roll` turns the camera anticlockwise, radians; `shift` is where the target stands right of and below the viewport's
 * middle, in viewport heights. Both are 0 where they are absent.
 */
export interface Pose {
  target: Vec3
  azimuth: number
  polar: number
  size: number
  slope: number
  roll?: number
  shift?: readonly [number, number]
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

/** Return the unit axes of a pose's camera, turned by its roll. */
function rolledAxes({ azimuth, polar, roll = 0 }: Pose): { right: Vec3; up: Vec3; back: Vec3 } {
  const { right, up, back } = axes(azimuth, polar)
  const [sin, cos] = [Math.sin(roll), Math.cos(roll)]
  const mix = (a: number, one: Vec3, b: number, other: Vec3): Vec3 => [
    a * one[0] + b * other[0],
    a * one[1] + b * other[1],
    a * one[2] + b * other[2],
  ]
  return { right: mix(cos, right, sin, up), up: mix(cos, up, -sin, right), back }
}

/** Return the camera's position in the world. */
export function eyeOf(pose: Pose): Vec3 {
  const { back } = axes(pose.azimuth, pose.polar)
  const distance = distanceOf(pose)
  return [pose.target[0] + back[0] * distance, pose.target[1] + back[1] * distance, pose.target[2] + back[2] * distance]
}

/** Return where the camera shows a world point, CSS px from the viewport's top left corner, y down. */
export function screenOf(pose: Pose, point: Vec3, viewport: Viewport): [number, number] {
  const [x, y] = projected(pose, point, viewport)
  return [x, y]
}

/** Return where the camera shows a world point, CSS px, and how far before the camera it lies, world units. */
export function projected(pose: Pose, point: Vec3, { width, height }: Viewport): [x: number, y: number, depth: number] {
  const { right, up, back } = rolledAxes(pose)
  const offset: Vec3 = [point[0] - pose.target[0], point[1] - pose.target[1], point[2] - pose.target[2]]
  const distance = distanceOf(pose)
  const depth = distance - dot(back, offset)
  const scale = ((height / pose.size) * distance) / depth
  const [across, down] = pose.shift ?? [0, 0]
  return [
    width / 2 + across * height + scale * dot(right, offset),
    height / 2 + down * height - scale * dot(up, offset),
    depth,
  ]
}

/** Return the world point that the camera shows at a place (CSS px) and lies `depth` world units before the camera. */
export function unprojected(
  pose: Pose,
  [x, y]: readonly [number, number],
  depth: number,
  { width, height }: Viewport,
): Vec3 {
  const { right, up, back } = rolledAxes(pose)
  const [across, down] = pose.shift ?? [0, 0]
  const distance = distanceOf(pose)
  const scale = ((height / pose.size) * distance) / depth
  const [toRight, toTop] = [(x - width / 2 - across * height) / scale, (height / 2 + down * height - y) / scale]
  const on = (axis: 0 | 1 | 2) =>
    pose.target[axis] + right[axis] * toRight + up[axis] * toTop + back[axis] * (distance - depth)
  return [on(0), on(1), on(2)]
}

/** Return a pose with a lens that shows everything larger by a factor, except a place that stays (CSS px). */
export function zoomedLens(pose: Pose, factor: number, [x, y]: readonly [number, number], viewport: Viewport): Pose {
  const [across, down] = [(x - viewport.width / 2) / viewport.height, (y - viewport.height / 2) / viewport.height]
  const shift = pose.shift ?? [0, 0]
  return {
    ...pose,
    size: pose.size / factor,
    slope: pose.slope / factor,
    shift: [across + (shift[0] - across) * factor, down + (shift[1] - down) * factor],
  }
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
    roll: mix(from.roll ?? 0, to.roll ?? 0),
    shift: [mix(from.shift?.[0] ?? 0, to.shift?.[0] ?? 0), mix(from.shift?.[1] ?? 0, to.shift?.[1] ?? 0)],
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
