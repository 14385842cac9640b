import type { Line, Point } from './strokes'

/** A straight segment, by its two ends. */
export type Segment = readonly [from: Point, to: Point]

export function distance([x, y]: Point, [otherX, otherY]: Point): number {
  return Math.hypot(otherX - x, otherY - y)
}

/** Return the point at a share (0..1) of the way along a segment. */
export function along([[x, y], [toX, toY]]: Segment, share: number): Point {
  return [x + share * (toX - x), y + share * (toY - y)]
}

/** Return the share (0..1) of a segment's length at which it is nearest to a point. */
export function nearestShare([[x, y], [toX, toY]]: Segment, [across, down]: Point): number {
  const square = (toX - x) ** 2 + (toY - y) ** 2
  if (square === 0) return 0
  return Math.min(Math.max(((across - x) * (toX - x) + (down - y) * (toY - y)) / square, 0), 1)
}

export function distanceToSegment(segment: Segment, point: Point): number {
  return distance(along(segment, nearestShare(segment, point)), point)
}

/** Return a point's distance from a line; a closed line returns to its start. Infinite for an empty line. */
export function distanceToLine(line: Line, point: Point, closed = false): number {
  let least = Number.POSITIVE_INFINITY
  for (let end = closed || line.length === 1 ? 0 : 1; end < line.length; end++) {
    const from = line[end === 0 ? line.length - 1 : end - 1]!
    least = Math.min(least, distanceToSegment([from, line[end]!], point))
  }
  return least
}

/** Return a line with fewer points, none of the others further than `tolerance` from it (Douglas and Peucker, 1973). */
export function simplified(line: Line, tolerance: number): Line {
  const [first, last] = [line[0]!, line.at(-1)!]
  const gaps = line.map(point => distanceToSegment([first, last], point))
  const bend = gaps.indexOf(gaps.reduce((most, gap) => Math.max(most, gap)))
  if (gaps[bend]! <= tolerance) return [first, last]
  return [...simplified(line.slice(0, bend + 1), tolerance), ...simplified(line.slice(bend), tolerance).slice(1)]
}

/** Return whether two segments have a point in common. */
export function intersect(one: Segment, other: Segment): boolean {
  return straddles(one, other) && straddles(other, one)
}

/** Return whether the second segment's ends lie on different sides of the first one's line, or on it. */
function straddles([from, to]: Segment, [first, last]: Segment): boolean {
  return side(from, to, first) * side(from, to, last) <= 0
}

/** Return on which side of a line through two points a third one lies: positive, negative, or 0 on the line. */
function side([x, y]: Point, [toX, toY]: Point, [across, down]: Point): number {
  return (toX - x) * (down - y) - (toY - y) * (across - x)
}
