import type { Vec3 } from '../camera'

/** A rotation, one scale and a move, 3 x 4 by rows: what leads from one frame of points to another. */
export type Similarity = readonly [Row, Row, Row]
type Row = readonly [number, number, number, number]

export const IDENTITY: Similarity = [
  [1, 0, 0, 0],
  [0, 1, 0, 0],
  [0, 0, 1, 0],
]

/** Return a point in the other frame. */
export function moved(by: Similarity, [x, y, z]: Vec3): Vec3 {
  const on = ([a, b, c, d]: Row) => a * x + b * y + c * z + d
  return [on(by[0]), on(by[1]), on(by[2])]
}

/** Return a direction, of length 1, in the other frame. */
export function turned(by: Similarity, [x, y, z]: Vec3): Vec3 {
  const scale = scaleOf(by)
  const on = ([a, b, c]: Row) => (a * x + b * y + c * z) / scale
  return [on(by[0]), on(by[1]), on(by[2])]
}

/** Return how long a length of 1 is in the other frame. */
export function scaleOf([row]: Similarity): number {
  return Math.hypot(row[0], row[1], row[2])
}

/** Return what leads to the second frame and from there on: `second` after `first`. */
export function after(second: Similarity, first: Similarity): Similarity {
  const at = (row: Row, column: 0 | 1 | 2 | 3) =>
    row[0] * first[0][column] + row[1] * first[1][column] + row[2] * first[2][column] + (column === 3 ? row[3] : 0)
  const rowOf = (row: Row): Row => [at(row, 0), at(row, 1), at(row, 2), at(row, 3)]
  return [rowOf(second[0]), rowOf(second[1]), rowOf(second[2])]
}

/** Return what leads back. */
export function inverse([a, b, c]: Similarity): Similarity {
  const square = a[0] ** 2 + a[1] ** 2 + a[2] ** 2
  const rowOf = (axis: 0 | 1 | 2): Row => {
    const turn: Vec3 = [a[axis] / square, b[axis] / square, c[axis] / square]
    return [...turn, -(turn[0] * a[3] + turn[1] * b[3] + turn[2] * c[3])]
  }
  return [rowOf(0), rowOf(1), rowOf(2)]
}

/** Return what turns by an angle about +Y (radians, from +Z to +X), scales, and moves a point `from` to a point `to`. */
export function placing(from: Vec3, to: Vec3, { turn, scale }: { turn: number; scale: number }): Similarity {
  const [sin, cos] = [Math.sin(turn) * scale, Math.cos(turn) * scale]
  return [
    [cos, 0, sin, to[0] - cos * from[0] - sin * from[2]],
    [0, scale, 0, to[1] - scale * from[1]],
    [-sin, 0, cos, to[2] + sin * from[0] - cos * from[2]],
  ]
}

/** Return what only scales. */
export function scaling(scale: number): Similarity {
  return placing([0, 0, 0], [0, 0, 0], { turn: 0, scale })
}
