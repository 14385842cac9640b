import { PerspectiveCamera, Vector3 } from 'three'
import { describe, expect, it } from 'vitest'
import {
  axes,
  type Box,
  depthRange,
  distanceOf,
  eyeOf,
  horizonOf,
  interpolate,
  PHOTO_SLOPE,
  type Pose,
  photoPose,
  photoRect,
  refit,
  screenOf,
  treePose,
  type Vec3,
  VIEW_SLOPE,
  worldOfPixel,
} from '../../src/preview/camera'

const UPRIGHT = { width: 1200, height: 1541, metres_per_pixel: 0.0114, root: [602.1, 1188.8] as [number, number] }
const WIDE = { width: 682, height: 300, metres_per_pixel: 0.018, root: [344.2, 299] as [number, number] }
const VIEWPORTS = [
  { width: 1440, height: 900 },
  { width: 390, height: 844 },
  { width: 800, height: 800 },
]
const TREE: Box = { min: [-0.4, 0, -0.5], max: [0.5, 0.8, 0.45] }

/** Where three's own camera shows a point, CSS px. */
function screenOfThree(pose: Pose, point: Vec3, viewport: { width: number; height: number }): [number, number] {
  const fov = (Math.atan(pose.slope) * 360) / Math.PI
  const camera = new PerspectiveCamera(fov, viewport.width / viewport.height, ...depthRange(pose, 6))
  camera.position.set(...eyeOf(pose))
  camera.lookAt(...pose.target)
  camera.updateMatrixWorld()
  const { x, y } = new Vector3(...point).project(camera)
  return [((x + 1) / 2) * viewport.width, ((1 - y) / 2) * viewport.height]
}

describe.each([UPRIGHT, WIDE])('the photo of $width x $height', photo => {
  it.each(VIEWPORTS)('lies whole and centred in $width x $height', viewport => {
    const rect = photoRect(photoPose(photo, viewport.width / viewport.height), photo, viewport)
    expect(Math.min(viewport.width - rect.width, viewport.height - rect.height)).toBeCloseTo(0, 6)
    expect(rect.x * 2 + rect.width).toBeCloseTo(viewport.width, 6)
    expect(rect.y * 2 + rect.height).toBeCloseTo(viewport.height, 6)
    expect(rect.width / rect.height).toBeCloseTo(photo.width / photo.height, 9)
  })

  it.each(VIEWPORTS)('has every pixel where the camera shows its world point in $width x $height', viewport => {
    const pose = photoPose(photo, viewport.width / viewport.height)
    const rect = photoRect(pose, photo, viewport)
    for (const [u, v] of [
      [0, 0],
      [1, 0],
      [0.3, 0.8],
      [1, 1],
    ] as const) {
      const [x, y] = screenOfThree(pose, worldOfPixel(photo, u * photo.width, v * photo.height), viewport)
      expect(Math.abs(x - (rect.x + u * rect.width))).toBeLessThan(0.05)
      expect(Math.abs(y - (rect.y + v * rect.height))).toBeLessThan(0.05)
    }
  })

  it.each(VIEWPORTS)(
    'shows what stands before and behind it in the same place to a pixel in $width x $height',
    viewport => {
      const pose = photoPose(photo, viewport.width / viewport.height)
      const [flat] = [screenOf(pose, [0.5, 0.4, 0], viewport)]
      for (const z of [-0.5, 0.5]) {
        const [x, y] = screenOf(pose, [0.5, 0.4, z], viewport)
        expect(Math.hypot(x - flat[0], y - flat[1])).toBeLessThan(1)
      }
    },
  )
})

describe('a view of the tree', () => {
  const directions = [
    [0, 1.44],
    [Math.PI / 2, 1.44],
    [Math.PI, 1.44],
    [0, 0.03],
    [0.62, 1.33],
  ] as const

  it.each(directions)('from %f, %f is projected as three does', (azimuth, polar) => {
    const pose = treePose(TREE, azimuth, polar, 1.6)
    const mine = screenOf(pose, [0.2, 0.7, -0.3], VIEWPORTS[0]!)
    const theirs = screenOfThree(pose, [0.2, 0.7, -0.3], VIEWPORTS[0]!)
    expect(Math.hypot(mine[0] - theirs[0], mine[1] - theirs[1])).toBeLessThan(0.01)
  })

  it.each(directions)('from %f, %f holds the ellipsoid in its box and little more', (azimuth, polar) => {
    for (const viewport of VIEWPORTS) {
      const pose = treePose(TREE, azimuth, polar, viewport.width / viewport.height)
      const reach = ellipsoid(TREE).map(point => {
        const [x, y] = screenOf(pose, point, viewport)
        return Math.max(Math.abs(x / viewport.width - 0.5), Math.abs(y / viewport.height - 0.5)) * 2
      })
      expect(Math.max(...reach)).toBeLessThan(0.97)
      expect(Math.max(...reach)).toBeGreaterThan(0.8)
    }
  })
})

describe('a flight', () => {
  const from = photoPose(UPRIGHT, 1.6)
  const to = treePose(TREE, Math.PI * 1.5, 1.44, 1.6)

  it('starts and ends where it should', () => {
    expect(interpolate(from, to, 0)).toMatchObject(from)
    const end = interpolate(from, to, 1)
    expect(eyeOf(end).map(part => part.toFixed(6))).toEqual(eyeOf(to).map(part => part.toFixed(6)))
  })

  it('turns the shorter way round', () => {
    expect(interpolate(from, to, 0.5).azimuth).toBeCloseTo(-Math.PI / 4, 9)
  })

  it('keeps the size at the target while the lens alone changes', () => {
    const wide = { ...from, slope: VIEW_SLOPE }
    const above: Vec3 = [from.target[0], from.target[1] + from.size / 4, from.target[2]]
    for (const t of [0, 0.1, 0.5, 1]) {
      const [, y] = screenOf(interpolate(from, wide, t), above, VIEWPORTS[0]!)
      expect(y).toBeCloseTo(VIEWPORTS[0]!.height / 4, 6)
    }
  })
})

it('stands farther away the longer the lens', () => {
  const pose = photoPose(UPRIGHT, 1.6)
  expect(distanceOf(pose)).toBeCloseTo(0.5 / PHOTO_SLOPE, 6)
  expect(distanceOf({ ...pose, slope: VIEW_SLOPE })).toBeLessThan(3)
})

it('has axes at right angles, right-handed', () => {
  const { right, up, back } = axes(0.7, 1.1)
  const cross = new Vector3(...right).cross(new Vector3(...up))
  expect(cross.distanceTo(new Vector3(...back))).toBeLessThan(1e-12)
})

it('keeps what is seen across the narrower side when the viewport changes', () => {
  const pose = treePose(TREE, 0, 1.4, 2)
  const narrow = refit(pose, 2, 0.5)
  expect(narrow.size * 0.5).toBeCloseTo(pose.size, 9)
  expect(refit(narrow, 0.5, 2).size).toBeCloseTo(pose.size, 9)
})

it("sees the horizon at the root's height in the photo's view", () => {
  const pose = photoPose(UPRIGHT, 1.6)
  const root = 1 - (2 * UPRIGHT.root[1]) / UPRIGHT.height
  expect(horizonOf(pose)).toBeCloseTo(root, 3)
})

function ellipsoid({ min, max }: Box): Vec3[] {
  const points: Vec3[] = []
  for (let a = 0; a < 24; a++)
    for (let p = 0; p <= 12; p++) {
      const { back } = axes((a * Math.PI) / 12, (p * Math.PI) / 12)
      const at = (axis: 0 | 1 | 2) => (min[axis] + max[axis]) / 2 + (back[axis] * (max[axis] - min[axis])) / 2
      points.push([at(0), at(1), at(2)])
    }
  return points
}
