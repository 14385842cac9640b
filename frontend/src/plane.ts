import type { Line, Point } from './strokes'

/** Two ends of a straight piece. */
export type Piece = readonly [from: Point, to: Point]

export function distance([x, y]: Point, [otherX, otherY]: Point): number {
  return Math.hypot(otherX - x, otherY - y)
}

/** The point a share of the way along a piece. */
export function along([[x, y], [toX, toY]]: Piece, share: number): Point {
  return [x + share * (toX - x), y + share * (toY - y)]
}

/** The share of a piece's length at which it comes nearest to a place. */
export function nearestShare([[x, y], [toX, toY]]: Piece, [across, down]: Point): number {
  const square = (toX - x) ** 2 + (toY - y) ** 2
  if (square === 0) return 0
  return Math.min(Math.max(((across - x) * (toX - x) + (down - y) * (toY - y)) / square, 0), 1)
}

export function distanceToPiece(piece: Piece, place: Point): number {
  return distance(along(piece, nearestShare(piece, place)), place)
}

/** Distance of a place from a line; a closed one goes back to its start. Infinite where there is no line. */
export function distanceToLine(line: Line, place: Point, closed = false): number {
  let least = Number.POSITIVE_INFINITY
  for (let end = closed || line.length === 1 ? 0 : 1; end < line.length; end++) {
    const from = line[end === 0 ? line.length - 1 : end - 1]!
    least = Math.min(least, distanceToPiece([from, line[end]!], place))
  }
  return least
}

/** Leave out of a line what lies no further than `apart` from the rest of it; its ends stay. */
export function simplified(line: Line, apart: number): Line {
  const [first, last] = [line[0]!, line.at(-1)!]
  const gaps = line.map(place => distanceToPiece([first, last], place))
  const bend = gaps.indexOf(gaps.reduce((most, gap) => Math.max(most, gap)))
  if (gaps[bend]! <= apart) return [first, last]
  return [...simplified(line.slice(0, bend + 1), apart), ...simplified(line.slice(bend), apart).slice(1)]
}

/** Whether two pieces have a point in common. */
export function cross(one: Piece, other: Piece): boolean {
  return straddles(one, other) && straddles(other, one)
}

function straddles([from, to]: Piece, [first, last]: Piece): boolean {
  return side(from, to, first) * side(from, to, last) <= 0
}

function side([x, y]: Point, [toX, toY]: Point, [across, down]: Point): number {
  return (toX - x) * (down - y) - (toY - y) * (across - x)
}
