import type { TraceAnswer, TracedSkeleton } from '../api/types'
import { distance, type Piece } from '../plane'
import type { Line } from '../strokes'
import { continues, pieceTo } from '../tracedBranch'
import { WIDTH } from './ink'

const smooth = new WeakMap<Line, Path2D>()
const foliage = new WeakMap<TraceAnswer, Path2D>()
const wood = new WeakMap<TracedSkeleton, Wood>()

/** A line as a smooth curve in photo px, from its first point to its last. Made once for each line. */
export function smoothPath(line: Line): Path2D {
  return once(smooth, line, () => curve(line))
}

/** A curve through the middles of a line's pieces, bent toward its points. */
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

/** A straight line with a tick of `arm` photo px to either side of each end. */
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

/** The rings of the foliage, to be filled by the even-odd rule. Made once for each answer. */
export function foliagePath(answer: TraceAnswer): Path2D {
  return once(foliage, answer, () => {
    const path = new Path2D()
    for (const [first, ...others] of answer.foliage) {
      if (!first) continue
      path.moveTo(...first)
      for (const place of others) path.lineTo(...place)
      path.closePath()
    }
    return path
  })
}

/** Branches as tapering wood; every radius is at least `least` and made `wider`, photo px. */
export function woodPath(skeleton: TracedSkeleton, joints: Iterable<number>, least: number, wider: number): Path2D {
  const path = new Path2D()
  const further = continues(skeleton)
  const roots = skeleton.points.filter((_, joint) => skeleton.parents[joint]! < 0)
  const radius = (joint: number) => Math.max(skeleton.radii[joint]!, least) + wider
  for (const joint of joints) {
    const [parent, thin] = [skeleton.parents[joint]!, radius(joint)]
    if (parent < 0) continue
    const piece = pieceTo(skeleton, joint)
    addTaper(path, piece, [further[joint] ? radius(parent) : thin, thin], skeleton.parents[parent]! < 0)
    // Nothing round may reach below the foot.
    for (const place of piece) addDisc(path, place, Math.min(thin, ...roots.map(root => distance(root, place))))
  }
  return path
}

/** A skeleton's wood at a scale (CSS px per photo px): a rim around all, under strokes, and found beside them. */
export interface Wood {
  readonly scale: number
  readonly rim: Path2D
  readonly stroked: Path2D
  readonly found: Path2D
}

/** Made anew only when the scale is another. */
export function woodAt(skeleton: TracedSkeleton, scale: number): Wood {
  const known = wood.get(skeleton)
  if (known?.scale === scale) return known
  const joints = [...skeleton.points.keys()]
  const least = WIDTH.thinnestWood / scale
  const of = (stroked: boolean) => joints.filter(joint => skeleton.stroke[joint]! >= 0 === stroked)
  const made = {
    scale,
    rim: woodPath(skeleton, joints, least, WIDTH.rim / scale),
    stroked: woodPath(skeleton, of(true), least, 0),
    found: woodPath(skeleton, of(false), least, 0),
  }
  wood.set(skeleton, made)
  return made
}

/** All parts turn the same way, so that they are filled as one. A piece that stands on the ground has a level foot. */
function addTaper(path: Path2D, [from, to]: Piece, [wide, thin]: readonly [number, number], stands: boolean): void {
  const length = distance(from, to)
  if (length === 0) return
  const [across, down] = [(to[1] - from[1]) / length, (from[0] - to[0]) / length]
  const foot =
    stands && across !== 0 ? ([Math.sign(across) * wide, 0] as const) : ([across * wide, down * wide] as const)
  path.moveTo(from[0] + foot[0], from[1] + foot[1])
  path.lineTo(to[0] + across * thin, to[1] + down * thin)
  path.lineTo(to[0] - across * thin, to[1] - down * thin)
  path.lineTo(from[0] - foot[0], from[1] - foot[1])
  path.closePath()
}

function addDisc(path: Path2D, [x, y]: readonly [number, number], radius: number): void {
  path.moveTo(x + radius, y)
  path.arc(x, y, radius, 0, 2 * Math.PI)
  path.closePath()
}

function once<K extends object>(made: WeakMap<K, Path2D>, key: K, make: () => Path2D): Path2D {
  const known = made.get(key)
  if (known) return known
  const path = make()
  made.set(key, path)
  return path
}
