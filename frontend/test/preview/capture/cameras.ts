import type { CameraInfo } from '../../../src/api/types'
import type { Vec3 } from '../../../src/preview/camera'

type Rows = CameraInfo['camera_from_world']

/** Return a camera at a place that looks at a point, turned by a roll (radians); its axis is off the photo's middle. */
export function cameraAt(photo: string, centre: Vec3, towards: Vec3, roll = 0): CameraInfo {
  const forward = unit([towards[0] - centre[0], towards[1] - centre[1], towards[2] - centre[2]])
  const level = unit(cross(forward, [0, 1, 0]))
  const below = cross(forward, level)
  const [sin, cos] = [Math.sin(roll), Math.cos(roll)]
  const right = mix(cos, level, sin, below)
  const down = mix(cos, below, -sin, level)
  const row = (axis: Vec3) => [...axis, -dot(axis, centre)] as Rows[0]
  return {
    photo,
    camera_from_world: [row(right), row(down), row(forward)],
    focal_px: 900,
    principal_px: [520, 460],
    size_px: [1000, 800],
  }
}

/** Return cameras around the origin, `count` of them in equal steps from +Z towards +X, at a distance and a height. */
export function ringOf(count: number, distance = 5, height = 1.5): CameraInfo[] {
  return Array.from({ length: count }, (_, at) => {
    const turn = (2 * Math.PI * at) / count
    return cameraAt(`${at}.jpg`, [Math.sin(turn) * distance, height, Math.cos(turn) * distance], [0, 1.5, 0])
  })
}

/** Return where a camera sees a point, px of its photo. */
export function seenAt({ camera_from_world: rows, focal_px, principal_px }: CameraInfo, point: Vec3): [number, number] {
  const on = (row: Rows[0]) => row[0] * point[0] + row[1] * point[1] + row[2] * point[2] + row[3]
  const [x, y, z] = [on(rows[0]), on(rows[1]), on(rows[2])]
  return [principal_px[0] + (focal_px * x) / z, principal_px[1] + (focal_px * y) / z]
}

function unit([x, y, z]: Vec3): Vec3 {
  const length = Math.hypot(x, y, z)
  return [x / length, y / length, z / length]
}

function cross(a: Vec3, b: Vec3): Vec3 {
  return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

function mix(a: number, one: Vec3, b: number, other: Vec3): Vec3 {
  return [a * one[0] + b * other[0], a * one[1] + b * other[1], a * one[2] + b * other[2]]
}

function dot(one: Vec3, other: Vec3): number {
  return one[0] * other[0] + one[1] * other[1] + one[2] * other[2]
}
