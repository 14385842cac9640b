import type { TraceAnswer, TracedSkeleton } from '../api/types'
import { distance, type Segment } from '../plane'
import type { Line } from '../strokes'
import { continuationsOf, segmentTo } from '../tracedBranch'
import { WIDTH } from './ink'

const smoothPaths = new WeakMap<Line, Path2D>()
const foliagePaths = new WeakMap<TraceAnswer, Path2D>()
const woods = new WeakMap<TracedSkeleton, Wood>()

/** Return a line as a smooth curve, sheet px; cached. */
export function smoothPath(line: Line): Path2D {
  return cached(smoothPaths, line, () => curve(line))
}

/** Return a smooth curve from a line's first point to its last, through the midpoints of its segments. */
export function curve(line: Line): Path2D {
  const path = new Path2D()
  const [first, ...others] = line
  if (!first) return path
  path.moveTo(...first)
  for (const [index, [x, y]] of others.entries()) {
    const next = others[index + 1]
    if (next) path.quadraticCurveTo(x, y, (x + next[0]) / 2, (y + next[1]) / 2)
    else path.lineTo(x, y)
  }
  if (others.length === 0) path.lineTo(...first)
  return path
}

/** Return a straight line with a tick across each end that is `arm` sheet px long to either side. */
export function rulerPath([from, to]: Line, arm: number): Path2D {
  const path = new Path2D()
  if (!from || !to) return path
  const length = distance(from, to) || 1
  const [right, down] = [((from[1] - to[1]) / length) * arm, ((to[0] - from[0]) / length) * arm]
  path.moveTo(...from)
  path.lineTo(...to)
  for (const [x, y] of [from, to]) {
    path.moveTo(x - right, y - down)
    path.lineTo(x + right, y + down)
  }
  return path
}

/** Return the outlines of the foliage, to be filled by the even-odd rule; cached. */
export function foliagePath(answer: TraceAnswer): Path2D {
  return cached(foliagePaths, answer, () => {
    const path = new Path2D()
    for (const [first, ...others] of answer.foliage) {
      if (!first) continue
      path.moveTo(...first)
      for (const point of others) path.lineTo(...point)
      path.closePath()
    }
    return path
  })
}

/** Return branches as tapering wood; each radius is raised to `minRadius`, then widened by `extra`, sheet px. */
export function woodPath(skeleton: TracedSkeleton, joints: Iterable<number>, minRadius: number, extra: number): Path2D {
  const path = new Path2D()
  const continued = continuationsOf(skeleton)
  const roots = skeleton.points.filter((_, joint) => skeleton.parents[joint]! < 0)
  const radius = (joint: number) => Math.max(skeleton.radii[joint]!, minRadius) + extra
  for (const joint of joints) {
    const [parent, end] = [skeleton.parents[joint]!, radius(joint)]
    if (parent < 0) continue
    const segment = segmentTo(skeleton, joint)
    addTaper(path, segment, [continued[joint] ? radius(parent) : end, end], skeleton.parents[parent]! < 0)
    // No disc may reach below the level foot.
    for (const point of segment) addDisc(path, point, Math.min(end, ...roots.map(root => distance(root, point))))
  }
  return path
}

/** A skeleton's wood at a scale, CSS px per sheet px: a rim around all, the branches with strokes, and those without. */
export interface Wood {
  readonly scale: number
  readonly rim: Path2D
  readonly stroked: Path2D
  readonly found: Path2D
}

/** Return a skeleton's wood at a scale, CSS px per sheet px; cached until the scale changes. */
export function woodAt(skeleton: TracedSkeleton, scale: number): Wood {
  const before = woods.get(skeleton)
  if (before?.scale === scale) return before
  const joints = [...skeleton.points.keys()]
  const minRadius = WIDTH.thinnestWood / scale
  const of = (stroked: boolean) => joints.filter(joint => skeleton.stroke[joint]! >= 0 === stroked)
  const wood = {
    scale,
    rim: woodPath(skeleton, joints, minRadius, WIDTH.rim / scale),
    stroked: woodPath(skeleton, of(true), minRadius, 0),
    found: woodPath(skeleton, of(false), minRadius, 0),
  }
  woods.set(skeleton, wood)
  return wood
}

/** Add a tapering segment. All have the same winding, so that they are filled as one; a root's has a level foot. */
function addTaper(path: Path2D, [from, to]: Segment, [start, end]: readonly [number, number], isRoot: boolean): void {
  const length = distance(from, to)
  if (length === 0) return
  const [across, down] = [(to[1] - from[1]) / length, (from[0] - to[0]) / length]
  const foot =
    isRoot && across !== 0 ? ([Math.sign(across) * start, 0] as const) : ([across * start, down * start] as const)
  path.moveTo(from[0] + foot[0], from[1] + foot[1])
  path.lineTo(to[0] + across * end, to[1] + down * end)
  path.lineTo(to[0] - across * end, to[1] - down * end)
  path.lineTo(from[0] - foot[0], from[1] - foot[1])
  path.closePath()
}

function addDisc(path: Path2D, [x, y]: readonly [number, number], radius: number): void {
  path.moveTo(x + radius, y)
  path.arc(x, y, radius, 0, 2 * Math.PI)
  path.closePath()
}

function cached<K extends object>(cache: WeakMap<K, Path2D>, key: K, make: () => Path2D): Path2D {
  const known = cache.get(key)
  if (known) return known
  const path = make()
  cache.set(key, path)
  return path
}
