import { distance } from '../plane'
import type { Line, Point } from '../strokes'
import type { DrawnKind } from './gesture'
import { type Size, within } from './viewport'

const MOST_POINTS = 10_000
const LEAST_DISTINCT = { crown: 3, branch: 2, scale: 2 }

/** A stroke under way, in photo px. It never leaves the photo. */
export class PenLine {
  #points: Point[] = []
  #coarseness = 1

  /** A measured line of which one end is moved begins at its other one. */
  constructor(
    readonly kind: DrawnKind,
    readonly photo: Size,
    from: Point | null = null,
    /** A brush's, photo px. */
    readonly width: number | null = null,
  ) {
    if (from) this.#points.push(from)
  }

  get points(): Line {
    return this.#points
  }

  /** Go on to a place, unless it lies nearer than `apart` photo px to the last one. Says whether it did. */
  add(place: Point, apart: number): boolean {
    const next = rounded(place, this.photo)
    const last = this.#points.at(-1)
    if (last && distance(last, next) < Math.max(apart * this.#coarseness, 0.01)) return false
    if (this.kind === 'scale') this.#points.splice(1)
    if (this.#points.length === MOST_POINTS) this.#thin()
    this.#points.push(next)
    return true
  }

  /** The finished stroke; null where it is too short to be one. */
  finished(): Line | null {
    const distinct = new Set(this.#points.map(String)).size
    return distinct < LEAST_DISTINCT[this.kind] ? null : [...this.#points]
  }

  #thin(): void {
    this.#points = this.#points.filter((_, index) => index % 2 === 0)
    this.#coarseness *= 2
  }
}

function rounded([x, y]: Point, { width, height }: Size): Point {
  const hundredth = (value: number, most: number) => Math.round(within(value, 0, most) * 100) / 100
  return [hundredth(x, width), hundredth(y, height)]
}
