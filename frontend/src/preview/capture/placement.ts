import type { CameraInfo } from '../../api/types'
import type { Box, Vec3 } from '../camera'
import { standpoint } from './photoCamera'
import { after, IDENTITY, placing, type Similarity, scaleOf, scaling } from './similarity'

/** Where the middle of what the photos show stands before the tree's root is known, preview world. */
const MIDDLE: Vec3 = [0, 0.45, 0]
/** Half the width, and the height, of a tree that is not known yet, preview world. */
const EXPECTED = { half: 0.4, height: 0.9 }

/** Return the point that cameras look at: the one nearest to all their axes; `cameras` is not empty. */
export function lookedAt(cameras: readonly CameraInfo[]): Vec3 {
  // Sums of (I - d dᵀ) and of (I - d dᵀ) c over the axes c + t d; a little of I keeps parallel axes from having none.
  const sums = [0, 0, 0, 0, 0, 0]
  const right = [0, 0, 0]
  for (const camera of cameras) {
    const { centre, forward } = standpoint(camera, IDENTITY)
    const along = centre[0] * forward[0] + centre[1] * forward[1] + centre[2] * forward[2]
    let at = 0
    for (const row of [0, 1, 2] as const) {
      for (let column = row; column < 3; column++)
        sums[at++]! += (row === column ? 1 + 1e-6 : 0) - forward[row] * forward[column]!
      right[row]! += (1 + 1e-6) * centre[row] - forward[row] * along
    }
  }
  const [a, b, c, d, e, f] = sums as [number, number, number, number, number, number]
  return solved([a, b, c], [b, d, e], [c, e, f], right as unknown as Vec3)
}

/** Return the solution of three equations, by Cramer's rule. */
function solved(one: Vec3, two: Vec3, three: Vec3, right: Vec3): Vec3 {
  const columns = [0, 1, 2].map(at => [one[at]!, two[at]!, three[at]!] as Vec3) as [Vec3, Vec3, Vec3]
  const whole = determinant(...columns)
  return [
    determinant(right, columns[1], columns[2]) / whole,
    determinant(columns[0], right, columns[2]) / whole,
    determinant(columns[0], columns[1], right) / whole,
  ]
}

function determinant(a: Vec3, b: Vec3, c: Vec3): number {
  return a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0]) + a[2] * (b[0] * c[1] - b[1] * c[0])
}

/** Return the angle of a direction about +Y, radians: 0 along +Z, turning to +X. */
export function azimuthOf([x, , z]: Vec3): number {
  return Math.atan2(x, z)
}

/**
 * Return what leads from a capture's frame to the preview's world before a tree was traced: what the cameras look at is
 * in the middle, the photo `front` was taken from +Z, and as in a photo's preview a photo's height is one unit there.
 */
export function placeUntraced(cameras: readonly CameraInfo[], front: string | null): Similarity {
  const middle = lookedAt(cameras)
  const away = ({ centre }: { centre: Vec3 }): Vec3 => [
    centre[0] - middle[0],
    centre[1] - middle[1],
    centre[2] - middle[2],
  ]
  const first = cameras.find(({ photo }) => photo === front) ?? cameras[0]!
  const turn = -azimuthOf(away(standpoint(first, IDENTITY)))
  const scale = 1 / heightInPhotos(cameras)
  return placing(middle, MIDDLE, { turn, scale })
}

/** Return what leads to the preview's world where the way to the tree's frame is known, but no tree is shown. */
export function placeTraced(cameras: readonly CameraInfo[], treeFromCapture: Similarity): Similarity {
  const units = 1 / (heightInPhotos(cameras) * scaleOf(treeFromCapture))
  return after(scaling(units), treeFromCapture)
}

/** Return the height that a photo shows at the distance of a point, in the median of the cameras. */
export function heightInPhotos(cameras: readonly CameraInfo[], point = lookedAt(cameras)): number {
  const heights = cameras.map(camera => {
    const { centre } = standpoint(camera, IDENTITY)
    const distance = Math.hypot(centre[0] - point[0], centre[1] - point[1], centre[2] - point[2])
    return (distance * camera.size_px[1]) / camera.focal_px
  })
  return heights.toSorted((one, other) => one - other)[Math.floor(heights.length / 2)]!
}

/** Return a box around the cameras and around where the tree is expected, preview world. */
export function boxOfCameras(cameras: readonly CameraInfo[], world: Similarity): Box {
  const places = cameras.map(camera => standpoint(camera, world).centre)
  const over = (axis: 0 | 1 | 2, pick: (...all: number[]) => number, own: number) =>
    pick(own, ...places.map(place => place[axis]))
  const { half, height } = EXPECTED
  return {
    min: [over(0, Math.min, -half), 0, over(2, Math.min, -half)],
    max: [over(0, Math.max, half), over(1, Math.max, height), over(2, Math.max, half)],
  }
}

/** Return what leads from the frame of some cameras to that of the same photos' cameras elsewhere; null where there are fewer than two. */
export function alignment(from: readonly CameraInfo[], to: readonly CameraInfo[]): Similarity | null {
  const others = new Map(to.map(camera => [camera.photo, camera]))
  const pairs = from.flatMap(camera => {
    const other = others.get(camera.photo)
    return other ? [[camera, other] as const] : []
  })
  if (pairs.length < 2) return null
  const [here, there] = [pairs.map(([one]) => placeOf(one)), pairs.map(([, other]) => placeOf(other))]
  const scale = spread(there) / spread(here)
  const turn = turnBetween(...pairs[0]!)
  const [middle, other] = [meanOf(here), meanOf(there)]
  const rows = turn.map((row, axis) => {
    const [a, b, c] = [row[0] * scale, row[1] * scale, row[2] * scale]
    return [a, b, c, other[axis]! - a * middle[0] - b * middle[1] - c * middle[2]] as const
  })
  return rows as unknown as Similarity
}

function placeOf(camera: CameraInfo): Vec3 {
  return standpoint(camera, IDENTITY).centre
}

/** Return the rotation from one camera's frame to the other's, by rows: R_otherᵀ R_one. */
function turnBetween(one: CameraInfo, other: CameraInfo): [Vec3, Vec3, Vec3] {
  const [r, s] = [one.camera_from_world, other.camera_from_world]
  const at = (row: number, column: number) =>
    s[0][row]! * r[0][column]! + s[1][row]! * r[1][column]! + s[2][row]! * r[2][column]!
  const rowOf = (row: number): Vec3 => [at(row, 0), at(row, 1), at(row, 2)]
  return [rowOf(0), rowOf(1), rowOf(2)]
}

function meanOf(points: readonly Vec3[]): Vec3 {
  const mean = (axis: 0 | 1 | 2) => points.reduce((sum, point) => sum + point[axis], 0) / points.length
  return [mean(0), mean(1), mean(2)]
}

/** Return the root of the sum of squared distances from the mean. */
function spread(points: readonly Vec3[]): number {
  const mean = meanOf(points)
  return Math.hypot(...points.flatMap(point => [0, 1, 2].map(axis => point[axis]! - mean[axis]!)))
}
