import type { CameraInfo } from './api/types'
import type { Spot } from './edits'
import type { Point } from './strokes'

/** Where a camera sees a point of the capture's frame. */
export interface Seen {
  /** Pixels of the upright photo. */
  readonly at: Point
  /** Distance along the direction of view, in the capture's unit; not positive behind the camera. */
  readonly depth: number
  /** Pixels of a length of one, across the direction of view at this depth. */
  readonly scale: number
}

/** Return where a camera sees a point. */
export function seenBy({ camera_from_world, focal_px, principal_px }: CameraInfo, spot: Spot): Seen {
  const [right, down, depth] = camera_from_world.map(row => rowTimes(row, spot)) as [number, number, number]
  const scale = focal_px / depth
  return { at: [principal_px[0] + scale * right, principal_px[1] + scale * down], depth, scale }
}

/** Return the point that a camera sees at a pixel, at a depth. */
export function spotAt({ camera_from_world, focal_px, principal_px }: CameraInfo, [x, y]: Point, depth: number): Spot {
  const scale = depth / focal_px
  const [right, down, ahead] = [(x - principal_px[0]) * scale, (y - principal_px[1]) * scale, depth]
  const fromOrigin = camera_from_world.map((row, axis) => [right, down, ahead][axis]! - row[3])
  const along = (axis: 0 | 1 | 2) => camera_from_world.reduce((sum, row, i) => sum + row[axis] * fromOrigin[i]!, 0)
  return [along(0), along(1), along(2)] // a rotation's inverse is its transpose
}

/** Return where a camera is. */
export function placeOf({ camera_from_world: rows }: CameraInfo): Spot {
  const along = (axis: 0 | 1 | 2) => -rows.reduce((sum, row) => sum + row[axis] * row[3], 0)
  return [along(0), along(1), along(2)]
}

function rowTimes([x, y, z, shift]: readonly [number, number, number, number], spot: Spot): number {
  return x * spot[0] + y * spot[1] + z * spot[2] + shift
}
