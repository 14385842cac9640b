/** A tree of a grove: which kind it is, where it stands (metres), how it is turned (radians) and its size as a factor. */
export interface Planted {
  readonly kind: number
  readonly x: number
  readonly z: number
  readonly turn: number
  readonly size: number
}

/** How far two trees stand apart, as a factor of both crowns' radii: leaves may touch. */
const APART = 0.92
/** The turn from one place of the spiral to the next. */
const GOLDEN = Math.PI * (3 - Math.sqrt(5))
/** How finely places are tried, as a factor of the mean radius. */
const FINENESS = 0.35
const SIZES = [0.88, 1.12] as const

/** Plant trees around a middle, so that crowns only touch; `radii` are those of the kinds' crowns, metres. */
export function plant(count: number, radii: readonly number[], seed: number): Planted[] {
  const random = randomFrom(seed)
  const planted: Planted[] = []
  const mean = radii.reduce((sum, radius) => sum + radius, 0) / radii.length
  for (let place = 0; planted.length < count; place++) {
    const next = treeAt(place, planted.length % radii.length, { mean, random })
    if (planted.every(other => areApart(next, other, radii))) planted.push(next)
  }
  return planted
}

function treeAt(place: number, kind: number, { mean, random }: { mean: number; random: () => number }): Planted {
  const away = FINENESS * mean * Math.sqrt(place)
  const around = place * GOLDEN + (random() - 0.5) * 0.6
  const size = SIZES[0] + (SIZES[1] - SIZES[0]) * random()
  return { kind, x: away * Math.cos(around), z: away * Math.sin(around), turn: 2 * Math.PI * random(), size }
}

function areApart(one: Planted, other: Planted, radii: readonly number[]): boolean {
  const least = APART * (radii[one.kind]! * one.size + radii[other.kind]! * other.size)
  return Math.hypot(one.x - other.x, one.z - other.z) >= least
}

/** Return a generator of numbers, 0 to 1, that are the same for the same seed (Mulberry32). */
function randomFrom(seed: number): () => number {
  let state = seed >>> 0
  return () => {
    state = (state + 0x6d2b79f5) >>> 0
    let mixed = Math.imul(state ^ (state >>> 15), state | 1)
    mixed ^= mixed + Math.imul(mixed ^ (mixed >>> 7), mixed | 61)
    return ((mixed ^ (mixed >>> 14)) >>> 0) / 2 ** 32
  }
}
