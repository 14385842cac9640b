import type { Point } from '../../strokes'

/** A piece of a branch: a curve that bends towards `bend`. */
export interface Twig {
  readonly from: Point
  readonly to: Point
  readonly bend: Point
  readonly width: number
  readonly level: number
}

/** A leaf from its stalk's end, `turn` radians clockwise from the right. */
export interface Leaf {
  readonly at: Point
  readonly turn: number
  readonly size: number
}

export interface DrawnTree {
  readonly twigs: readonly Twig[]
  readonly leaves: readonly Leaf[]
}

interface Shoot {
  readonly from: Point
  /** Radians from straight up, clockwise. */
  readonly angle: number
  readonly length: number
  readonly level: number
  /** Whether it continues the trunk. */
  readonly leads: boolean
}

type Fork = Pick<Shoot, 'leads'> & { readonly turn: number; readonly share: number }

const ROOT: Point = [220, 376]
/** How often branches fork. */
export const LEVELS = 6
/** A branch's angle to the vertical shrinks by this factor at each fork. */
const STRAIGHTENING = 0.9
const MIDDLE: Point = [220, 172]
/** How far the crown's line stays from the leaves. */
const MARGIN = 15
const DIRECTIONS = 26
/** Least distance of the crown's line from its middle. */
const NEAREST = 84

/** Return the tree of the illustration, which is always the same. */
export function drawnTree(): DrawnTree {
  const random = randomFrom(11)
  const twigs: Twig[] = []
  const leaves: Leaf[] = []
  const grow = ({ from, angle, length, level, leads }: Shoot): void => {
    const to: Point = [from[0] + length * Math.sin(angle), from[1] - length * Math.cos(angle)]
    const side = (random() - 0.5) * length * 0.3
    const bend: Point = [(from[0] + to[0]) / 2 + side * Math.cos(angle), (from[1] + to[1]) / 2 + side * Math.sin(angle)]
    twigs.push({ from, to, bend, width: 13 * 0.56 ** level, level })
    if (level >= 3 && !leads) leaves.push(...cluster(to, level, random))
    if (level === LEVELS) return
    for (const { turn, share, leads: further } of forks(leads, random)) {
      grow({
        from: to,
        angle: (angle + turn) * STRAIGHTENING,
        length: length * share,
        level: level + 1,
        leads: further,
      })
    }
  }
  grow({ from: ROOT, angle: 0.02, length: 76, level: 0, leads: true })
  return { twigs, leaves }
}

/** Return the crown's line: a loose loop around the leaves that begins and ends near the trunk. */
export function outline({ leaves }: DrawnTree): string {
  const reach = Array.from({ length: DIRECTIONS }, (_, index) => farthest(leaves, (index * 2 * Math.PI) / DIRECTIONS))
  const smoothed = reach.map((own, index) =>
    Math.max(own * 0.97, (reach.at(index - 1)! + own + reach[(index + 1) % DIRECTIONS]!) / 3),
  )
  const points = smoothed.map((far, index): Point => {
    const angle = (index * 2 * Math.PI) / DIRECTIONS
    return [MIDDLE[0] - (far + MARGIN) * Math.sin(angle), MIDDLE[1] + (far + MARGIN) * Math.cos(angle)]
  })
  return curveThrough([...points, points[0]!, [points[1]![0], points[1]![1] + 7]])
}

function forks(leads: boolean, random: () => number): Fork[] {
  const to = (side: number, spread: number): Fork => ({
    turn: side * (spread + 0.2 * random()),
    share: (leads ? 0.68 : 0.7) + 0.17 * random(),
    leads: false,
  })
  if (!leads) return random() < 0.35 ? [to(-1, 0.5), to(1, 0), to(1, 0.5)] : [to(-1, 0.38), to(1, 0.38)]
  const on = { turn: (random() - 0.5) * 0.2, share: 0.82, leads: true }
  return [to(-1, 0.75), on, to(1, 0.75)]
}

function cluster([x, y]: Point, level: number, random: () => number): Leaf[] {
  return Array.from({ length: level > 4 ? 3 : 2 }, () => ({
    at: [x + 22 * (random() - 0.5), y + 22 * (random() - 0.5)] as Point,
    turn: 2 * Math.PI * random(),
    size: 0.75 + 0.7 * random(),
  }))
}

/** Return how far leaves reach from the middle in a direction, radians clockwise from straight down. */
function farthest(leaves: readonly Leaf[], angle: number): number {
  const along = leaves.map(({ at }) => {
    const [right, down] = [at[0] - MIDDLE[0], at[1] - MIDDLE[1]]
    const turn = Math.atan2(-right, down) - angle
    const gap = Math.abs(Math.atan2(Math.sin(turn), Math.cos(turn)))
    return gap < 0.2 ? Math.hypot(right, down) : NEAREST
  })
  return Math.max(NEAREST, ...along)
}

/** Return a smooth curve through points. */
function curveThrough(points: readonly Point[]): string {
  const at = (index: number) => points[Math.min(points.length - 1, Math.max(0, index))]!
  const parts = points.slice(1).map((to, index) => {
    const [before, from, after] = [at(index - 1), at(index), at(index + 2)]
    const first = [from[0] + (to[0] - before[0]) / 6, from[1] + (to[1] - before[1]) / 6]
    const second = [to[0] - (after[0] - from[0]) / 6, to[1] - (after[1] - from[1]) / 6]
    return `C${[...first, ...second, ...to].map(value => value.toFixed(1)).join(' ')}`
  })
  return `M${points[0]!.map(value => value.toFixed(1)).join(' ')}${parts.join('')}`
}

/** Return a generator of numbers from 0 to 1, the same ones for the same seed. */
function randomFrom(seed: number): () => number {
  let state = seed
  return () => {
    state = (state * 1664525 + 1013904223) % 4294967296
    return state / 4294967296
  }
}
