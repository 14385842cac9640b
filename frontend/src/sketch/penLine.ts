import { distance } from '../plane'
import type { Line, Point } from '../strokes'
import type { DrawnKind } from './gesture'
import { type Size, within } from './viewport'

const MAX_POINTS = 10_000
/** How many different points a stroke needs at least. */
const MIN_DISTINCT = { crown: 3, branch: 2, scale: 2 }

/** The stroke that is being drawn, in sheet px; it never leaves the sheet. */
export class PenLine {
  #points: Point[] = []
  /** Factor of the least distance between points; doubles each time that points are dropped. */
  #coarseness = 1

  /** Begins at `from` where one is given: the end of a measured line that stays while the other is moved. */
  constructor(
    readonly kind: DrawnKind,
    readonly sheet: Size,
    from: Point | null = null,
    /** The brush's width, sheet px; null for a pencil. */
    readonly width: number | null = null,
  ) {
    if (from) this.#points.push(from)
  }

  get points(): Line {
    return this.#points
  }

  /** Add a point unless it lies nearer than `spacing` sheet px to the last one. */
  add(point: Point, spacing: number): void {
    const next = rounded(point, this.sheet)
    const last = this.#points.at(-1)
    if (last && distance(last, next) < Math.max(spacing * this.#coarseness, 0.01)) return
    if (this.kind === 'scale') this.#points.splice(1)
    if (this.#points.length === MAX_POINTS) this.#thin()
    this.#points.push(next)
  }

  /** Return the finished stroke; null where it has too few different points. */
  finished(): Line | null {
    const distinct = new Set(this.#points.map(String)).size
    return distinct < MIN_DISTINCT[this.kind] ? null : [...this.#points]
  }

  #thin(): void {
    this.#points = this.#points.filter((_, index) => index % 2 === 0)
    this.#coarseness *= 2
  }
}

/** Return the nearest point on the sheet, rounded to hundredths of a px. */
function rounded([x, y]: Point, { width, height }: Size): Point {
  const hundredth = (value: number, most: number) => Math.round(within(value, 0, most) * 100) / 100
  return [hundredth(x, width), hundredth(y, height)]
}
