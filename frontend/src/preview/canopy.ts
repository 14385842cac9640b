import type { Vec3 } from './camera'

/** How much light reaches each cell of a grid around a crown: two shares a cell, of the sky's and of the sun's, 0..1. */
export interface Canopy {
  origin: Vec3
  /** A cell's side. */
  cell: number
  /** How many cells there are along x, y and z. */
  cells: readonly [number, number, number]
  light: Float32Array
}

/** Cells along the crown's longest side. */
const LONGEST_CELLS = 26
/** Optical depth of a cell of average foliage; chosen by eye. */
const ABSORPTION = 0.24
/** How far light is followed, in cells. */
const PATH_CELLS = 12
/** Directions from which the sky's light comes. */
const SKY: Vec3[] = [
  [0, 1, 0],
  [0.75, 0.66, 0],
  [-0.75, 0.66, 0],
  [0, 0.66, 0.75],
  [0, 0.66, -0.75],
  [0.7, -0.1, 0.7],
  [-0.7, -0.1, 0.7],
  [0.7, -0.1, -0.7],
  [-0.7, -0.1, -0.7],
]

/** Return the light in a crown, given its leaves' vertices (x, y, z each) and the direction to the sun. */
export function canopyOf(leaves: ArrayLike<number>, sun: Vec3): Canopy {
  const { origin, cell, cells } = gridAround(leaves)
  const foliage = foliageIn(leaves, origin, cell, cells)
  const light = new Float32Array(foliage.length * 2)
  const steps = SKY.map(direction => stepsOf(direction))
  const toSun = stepsOf(sun)
  let at = 0
  for (let z = 0; z < cells[2]; z++)
    for (let y = 0; y < cells[1]; y++)
      for (let x = 0; x < cells[0]; x++) {
        const from: Vec3 = [x, y, z]
        let sky = 0
        for (const path of steps) sky += transmitted(foliage, cells, from, path)
        light[at++] = sky / steps.length
        light[at++] = transmitted(foliage, cells, from, toSun)
      }
  return { origin, cell, cells, light }
}

/** Return the light at each vertex (x, y, z each) as two bytes: the sky's and the sun's share. */
export function lightAt(canopy: Canopy, vertices: ArrayLike<number>): Uint8Array {
  const lit = new Uint8Array((vertices.length / 3) * 2)
  const point = new Float64Array(3)
  for (let vertex = 0; vertex * 3 < vertices.length; vertex++) {
    for (let axis = 0; axis < 3; axis++)
      point[axis] = (vertices[vertex * 3 + axis]! - canopy.origin[axis]!) / canopy.cell - 0.5
    lit[vertex * 2] = Math.round(255 * interpolated(canopy, point, 0))
    lit[vertex * 2 + 1] = Math.round(255 * interpolated(canopy, point, 1))
  }
  return lit
}

/**
 * Return the shadow that vertices throw on the ground: `side` x `side` bytes (255 is darkest) over a square of half-width
 * `radius` around `centre` [x, z]; row 0 is at -z.
 */
export function groundShadow(
  vertices: ArrayLike<number>,
  sun: Vec3,
  ground: { centre: readonly [number, number]; radius: number; side: number },
): Uint8Array {
  const { centre, radius, side } = ground
  const counts = new Float32Array(side * side)
  for (let at = 0; at < vertices.length; at += 3) {
    const height = vertices[at + 1]! / sun[1]
    const column = ((vertices[at]! - sun[0] * height - centre[0]) / radius + 1) * 0.5 * side
    const row = ((vertices[at + 2]! - sun[2] * height - centre[1]) / radius + 1) * 0.5 * side
    if (column >= 0 && row >= 0 && column < side && row < side) counts[Math.floor(row) * side + Math.floor(column)]!++
  }
  const blurred = blur(blur(counts, side), side)
  const mean = vertices.length / 3 / (side * side)
  return Uint8Array.from(blurred, count => 255 * (1 - Math.exp((-0.45 * count) / mean)))
}

function gridAround(leaves: ArrayLike<number>): Pick<Canopy, 'origin' | 'cell' | 'cells'> {
  const [low, high] = [
    [Infinity, Infinity, Infinity],
    [-Infinity, -Infinity, -Infinity],
  ]
  for (let at = 0; at < leaves.length; at++) {
    low![at % 3] = Math.min(low![at % 3]!, leaves[at]!)
    high![at % 3] = Math.max(high![at % 3]!, leaves[at]!)
  }
  const longest = Math.max(high![0]! - low![0]!, high![1]! - low![1]!, high![2]! - low![2]!, 1e-6)
  const cell = longest / LONGEST_CELLS
  const cells = [0, 1, 2].map(axis => Math.floor((high![axis]! - low![axis]!) / cell) + 1)
  return { origin: [low![0]!, low![1]!, low![2]!], cell, cells: [cells[0]!, cells[1]!, cells[2]!] }
}

/** Return the amount of foliage in each cell; the mean of cells with any is 1. */
function foliageIn(leaves: ArrayLike<number>, origin: Vec3, cell: number, cells: Canopy['cells']): Float32Array {
  const foliage = new Float32Array(cells[0] * cells[1] * cells[2])
  for (let at = 0; at < leaves.length; at += 3) {
    const x = Math.floor((leaves[at]! - origin[0]) / cell)
    const y = Math.floor((leaves[at + 1]! - origin[1]) / cell)
    const z = Math.floor((leaves[at + 2]! - origin[2]) / cell)
    foliage[(z * cells[1] + y) * cells[0] + x]! += 1
  }
  const full = foliage.reduce((count, here) => count + (here > 0 ? 1 : 0), 0)
  const mean = leaves.length / 3 / Math.max(full, 1)
  return foliage.map(here => here / mean)
}

/** Return offsets from a cell along a direction, one cell apart: x, y, z each. */
function stepsOf(direction: Vec3): Int8Array {
  const length = Math.hypot(...direction)
  const steps = new Int8Array(PATH_CELLS * 3)
  for (let at = 0; at < steps.length; at++)
    steps[at] = Math.round((direction[(at % 3) as 0 | 1 | 2] / length) * (Math.floor(at / 3) + 1))
  return steps
}

/** Return the share of light that reaches a cell along `steps`, 0..1. */
function transmitted(foliage: Float32Array, cells: Canopy['cells'], from: Vec3, steps: Int8Array): number {
  let depth = foliage[(from[2] * cells[1] + from[1]) * cells[0] + from[0]]! * 0.5
  for (let step = 0; step < steps.length; step += 3) {
    const x = from[0] + steps[step]!
    const y = from[1] + steps[step + 1]!
    const z = from[2] + steps[step + 2]!
    if (x < 0 || y < 0 || z < 0 || x >= cells[0] || y >= cells[1] || z >= cells[2]) break
    depth += foliage[(z * cells[1] + y) * cells[0] + x]!
  }
  return Math.exp(-ABSORPTION * depth)
}

/** Return the interpolated light at a point (in cells, from the first one's centre); outside the grid, the nearest cell's. */
function interpolated({ cells, light }: Canopy, point: Float64Array, kind: number): number {
  let sum = 0
  for (let corner = 0; corner < 8; corner++) {
    let at = 0
    let weight = 1
    let stride = 1
    for (let axis = 0; axis < 3; axis++) {
      const low = Math.floor(point[axis]!)
      const upper = (corner >> axis) & 1
      const part = point[axis]! - low
      weight *= upper ? part : 1 - part
      at += stride * Math.min(Math.max(low + upper, 0), cells[axis]! - 1)
      stride *= cells[axis]!
    }
    sum += weight * light[at * 2 + kind]!
  }
  return sum
}

/** Return a picture of `side` x `side` in which each pixel is the mean of its 3 x 3 neighbourhood. */
function blur(picture: Float32Array, side: number): Float32Array {
  const blurred = new Float32Array(picture.length)
  for (let at = 0; at < picture.length; at++) {
    const [row, column] = [Math.floor(at / side), at % side]
    for (let r = Math.max(row - 1, 0); r <= Math.min(row + 1, side - 1); r++)
      for (let c = Math.max(column - 1, 0); c <= Math.min(column + 1, side - 1); c++)
        blurred[at]! += picture[r * side + c]! / 9
  }
  return blurred
}
