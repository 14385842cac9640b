import type { CameraInfo } from '../../api/types'
import { axes, type Pose, type Rect, type Vec3, type Viewport } from '../camera'
import { moved, type Similarity, turned } from './similarity'

/** Where a photo's camera stands, with the directions of its axes, each of length 1. */
export interface Standpoint {
  readonly centre: Vec3
  readonly right: Vec3
  readonly down: Vec3
  readonly forward: Vec3
}

/** Return a photo's camera in another frame than that of `camera_from_world`. */
export function standpoint(
  { camera_from_world: rows }: Pick<CameraInfo, 'camera_from_world'>,
  to: Similarity,
): Standpoint {
  const axis = (row: 0 | 1 | 2): Vec3 => [rows[row][0], rows[row][1], rows[row][2]]
  const centreOn = (column: 0 | 1 | 2) =>
    -(rows[0][column] * rows[0][3] + rows[1][column] * rows[1][3] + rows[2][column] * rows[2][3])
  return {
    centre: moved(to, [centreOn(0), centreOn(1), centreOn(2)]),
    right: turned(to, axis(0)),
    down: turned(to, axis(1)),
    forward: turned(to, axis(2)),
  }
}

/** Return the largest rectangle of a photo's shape in the middle of a viewport, CSS px. */
export function fittedRect([width, height]: readonly [number, number], viewport: Viewport): Rect {
  const scale = Math.min(viewport.width / width, viewport.height / height)
  const [across, down] = [width * scale, height * scale]
  return { x: (viewport.width - across) / 2, y: (viewport.height - down) / 2, width: across, height: down }
}

/**
 * Return the pose of a photo's camera: it shows the world as the photo does, where the photo lies in its fitted
 * rectangle. It turns about the point of its axis that is nearest to `about`, a world point.
 *
 * The camera is that of the photo without its lens's distortion, and the photo is shown as it was taken: towards its
 * corners the two may lie some px apart.
 */
export function cameraPose(camera: CameraInfo, world: Similarity, about: Vec3, viewport: Viewport): Pose {
  const { centre, right, forward } = standpoint(camera, world)
  const distance = Math.max(dot(forward, difference(about, centre)), 0.05)
  const polar = Math.acos(Math.min(Math.max(-forward[1], -1), 1))
  const azimuth = Math.atan2(-forward[0], -forward[2])
  const level = axes(azimuth, polar)
  const rect = fittedRect(camera.size_px, viewport)
  const perPx = rect.width / camera.size_px[0]
  const slope = viewport.height / 2 / (camera.focal_px * perPx)
  const [x, y] = camera.principal_px
  return {
    target: [0, 1, 2].map(axis => centre[axis]! + forward[axis]! * distance) as unknown as Vec3,
    azimuth,
    polar,
    size: 2 * distance * slope,
    slope,
    roll: Math.atan2(dot(right, level.up), dot(right, level.right)),
    shift: [
      (rect.x + x * perPx - viewport.width / 2) / viewport.height,
      (rect.y + y * perPx - viewport.height / 2) / viewport.height,
    ],
  }
}

/** Return where a photo lies in the viewport, seen by its camera's pose, whatever its lens was zoomed to. */
export function pictureRect(camera: CameraInfo, { slope, shift = [0, 0] }: Pose, { width, height }: Viewport): Rect {
  const perPx = height / 2 / (slope * camera.focal_px)
  const [x, y] = camera.principal_px
  return {
    x: width / 2 + shift[0] * height - x * perPx,
    y: height / 2 + shift[1] * height - y * perPx,
    width: camera.size_px[0] * perPx,
    height: camera.size_px[1] * perPx,
  }
}

/** Return the corners of a camera's picture, `depth` before it: top left, top right, bottom right, bottom left. */
export function pictureCorners(
  camera: CameraInfo,
  { centre, right, down, forward }: Standpoint,
  depth: number,
): Vec3[] {
  const [width, height] = camera.size_px
  return [
    [0, 0],
    [width, 0],
    [width, height],
    [0, height],
  ].map(([x, y]) => {
    const [across, below] = [
      (x! - camera.principal_px[0]) / camera.focal_px,
      (y! - camera.principal_px[1]) / camera.focal_px,
    ]
    const on = (axis: 0 | 1 | 2) => centre[axis] + depth * (forward[axis] + across * right[axis] + below * down[axis])
    return [on(0), on(1), on(2)]
  })
}

function difference(one: Vec3, other: Vec3): Vec3 {
  return [one[0] - other[0], one[1] - other[1], one[2] - other[2]]
}

function dot(one: Vec3, other: Vec3): number {
  return one[0] * other[0] + one[1] * other[1] + one[2] * other[2]
}
