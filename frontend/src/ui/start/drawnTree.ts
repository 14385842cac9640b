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
  /** Whether it carries the trunk on. */
  readonly leads: boolean
}

type Fork = Pick<Shoot, 'leads'> & { readonly turn: number; readonly share: number }

const ROOT: Point = [220, 376]
/** How often branches fork. */
export const LEVELS = 6
/** What is left of a branch's angle to the upright from one fork to the next: it rises to the light. */
const RISE = 0.9
const MIDDLE: Point = [220, 172]
/** How far the crown's line stays from the leaves. */
const MARGIN = 15
const DIRECTIONS = 26
/** Of the line to the crown's middle. */
const NEAREST = 84

/** Grow the tree of the illustration: always the same one. */
export function drawnTree(): DrawnTree {
  const chance = randomFrom(11)
  const twigs: Twig[] = []
  const leaves: Leaf[] = []
  const grow = ({ from, angle, length, level, leads }: Shoot): void => {
    const to: Point = [from[0] + length * Math.sin(angle), from[1] - length * Math.cos(angle)]
    const side = (chance() - 0.5) * length * 0.3
    const bend: Point = [(from[0] + to[0]) / 2 + side * Math.cos(angle), (from[1] + to[1]) / 2 + side * Math.sin(angle)]
    twigs.push({ from, to, bend, width: 13 * 0.56 ** level, level })
    if (level >= 3 && !leads) leaves.push(...tuft(to, level, chance))
    if (level === LEVELS) return
    for (const { turn, share, leads: further } of forks(leads, chance)) {
      grow({ from: to, angle: (angle + turn) * RISE, length: length * share, level: level + 1, leads: further })
    }
  }
  grow({ from: ROOT, angle: 0.02, length: 76, level: 0, leads: true })
  return { twigs, leaves }
}

/** Draw the crown's line: a loose loop around the leaves that begins and ends near the trunk. */
export function outline({ leaves }: DrawnTree): string {
  const reach = Array.from({ length: DIRECTIONS }, (_, index) => farthest(leaves, (index * 2 * Math.PI) / DIRECTIONS))
  const calm = reach.map((own, index) =>
    Math.max(own * 0.97, (reach.at(index - 1)! + own + reach[(index + 1) % DIRECTIONS]!) / 3),
  )
  const points = calm.map((far, index): Point => {
    const angle = (index * 2 * Math.PI) / DIRECTIONS
    return [MIDDLE[0] - (far + MARGIN) * Math.sin(angle), MIDDLE[1] + (far + MARGIN) * Math.cos(angle)]
  })
  return smooth([...points, points[0]!, [points[1]![0], points[1]![1] + 7]])
}

function forks(leads: boolean, chance: () => number): Fork[] {
  const to = (side: number, spread: number): Fork => ({
    turn: side * (spread + 0.2 * chance()),
    share: (leads ? 0.68 : 0.7) + 0.17 * chance(),
    leads: false,
  })
  if (!leads) return chance() < 0.35 ? [to(-1, 0.5), to(1, 0), to(1, 0.5)] : [to(-1, 0.38), to(1, 0.38)]
  const on = { turn: (chance() - 0.5) * 0.2, share: 0.82, leads: true }
  return [to(-1, 0.75), on, to(1, 0.75)]
}

function tuft([x, y]: Point, level: number, chance: () => number): Leaf[] {
  return Array.from({ length: level > 4 ? 3 : 2 }, () => ({
    at: [x + 22 * (chance() - 0.5), y + 22 * (chance() - 0.5)] as Point,
    turn: 2 * Math.PI * chance(),
    size: 0.75 + 0.7 * chance(),
  }))
}

/** Find how far leaves lie from the middle in a direction, radians clockwise from straight down. */
function farthest(leaves: readonly Leaf[], angle: number): number {
  const along = leaves.map(({ at }) => {
    const [right, down] = [at[0] - MIDDLE[0], at[1] - MIDDLE[1]]
    const turn = Math.atan2(-right, down) - angle
    const gap = Math.abs(Math.atan2(Math.sin(turn), Math.cos(turn)))
    return gap < 0.2 ? Math.hypot(right, down) : NEAREST
  })
  return Math.max(NEAREST, ...along)
}

/** Lay a curve through points. */
function smooth(points: readonly Point[]): string {
  const at = (index: number) => points[Math.min(points.length - 1, Math.max(0, index))]!
  const parts = points.slice(1).map((to, index) => {
    const [before, from, after] = [at(index - 1), at(index), at(index + 2)]
    const first = [from[0] + (to[0] - before[0]) / 6, from[1] + (to[1] - before[1]) / 6]
    const second = [to[0] - (after[0] - from[0]) / 6, to[1] - (after[1] - from[1]) / 6]
    return `C${[...first, ...second, ...to].map(value => value.toFixed(1)).join(' ')}`
  })
  return `M${points[0]!.map(value => value.toFixed(1)).join(' ')}${parts.join('')}`
}

function randomFrom(seed: number): () => number {
  let state = seed
  return () => {
    state = (state * 1664525 + 1013904223) % 4294967296
    return state / 4294967296
  }
}
