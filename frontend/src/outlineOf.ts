import type { Line, Point } from './strokes'

/** A picture's pixels: red, green, blue and opacity each, 0 to 255. */
export interface Pixels {
  readonly width: number
  readonly height: number
  readonly data: ArrayLike<number>
}

/** From here on a pixel counts as opaque; below, as dark. */
const HALF = 128
/** The most points of an outline. */
const MOST = 240
/** The eight neighbours in order round a pixel. */
const AROUND: readonly Point[] = [
  [1, 0],
  [1, 1],
  [0, 1],
  [-1, 1],
  [-1, 0],
  [-1, -1],
  [0, -1],
  [1, -1],
]

/** Return the outline of a picture's largest shape, px: what is opaque, or dark where all is opaque; null where there is none. */
export function outlineOf(picture: Pixels): Line | null {
  const shape = largestShape(shapeIn(picture), picture)
  const first = shape.indexOf(1)
  if (first < 0) return null
  const edge = edgeFrom(first, shape, picture)
  const step = Math.max(1, Math.ceil(edge.length / MOST))
  const outline = edge.filter((_, at) => at % step === 0)
  return outline.length < 3 ? null : outline
}

function shapeIn({ width, height, data }: Pixels): Uint8Array {
  const pixels = Array.from({ length: width * height }, (_, at) => at)
  const isCutOut = pixels.some(at => data[at * 4 + 3]! < HALF)
  const isIn = (at: number) => (isCutOut ? data[at * 4 + 3]! >= HALF : brightness(data, at) < HALF)
  return Uint8Array.from(pixels, at => Number(isIn(at)))
}

function brightness(data: ArrayLike<number>, at: number): number {
  return 0.3 * data[at * 4]! + 0.6 * data[at * 4 + 1]! + 0.1 * data[at * 4 + 2]!
}

/** Return the largest connected shape alone. */
function largestShape(shape: Uint8Array, { width, height }: Pixels): Uint8Array {
  const seen = new Uint8Array(shape.length)
  let largest: number[] = []
  for (let start = 0; start < shape.length; start++) {
    if (!shape[start] || seen[start]) continue
    const part = fill(start, shape, seen, { width, height })
    if (part.length > largest.length) largest = part
  }
  const alone = new Uint8Array(shape.length)
  for (const at of largest) alone[at] = 1
  return alone
}

function fill(start: number, shape: Uint8Array, seen: Uint8Array, size: Pick<Pixels, 'width' | 'height'>): number[] {
  const part = [start]
  seen[start] = 1
  for (let next = 0; next < part.length; next++)
    for (const side of [0, 2, 4, 6]) {
      const at = neighbour(part[next]!, side, size)
      if (at === null || !shape[at] || seen[at]) continue
      seen[at] = 1
      part.push(at)
    }
  return part
}

/** Return the pixels round a shape in order, from its first one (Moore's neighbour tracing). */
function edgeFrom(first: number, shape: Uint8Array, size: Pixels): Point[] {
  const edge: Point[] = []
  let [at, facing] = [first, 0]
  do {
    edge.push([(at % size.width) + 0.5, Math.floor(at / size.width) + 0.5])
    const turn = AROUND.findIndex((_, step) => {
      const next = neighbour(at, (facing + 6 + step) % 8, size)
      return next !== null && shape[next] === 1
    })
    if (turn < 0) break
    facing = (facing + 6 + turn) % 8
    at = neighbour(at, facing, size)!
  } while (at !== first && edge.length < shape.length)
  return edge
}

function neighbour(at: number, side: number, { width, height }: Pick<Pixels, 'width' | 'height'>): number | null {
  const [across, down] = AROUND[side]!
  const [x, y] = [(at % width) + across, Math.floor(at / width) + down]
  return x < 0 || y < 0 || x >= width || y >= height ? null : y * width + x
}
