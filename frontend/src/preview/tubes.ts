import type { Grown } from '../api/types'

/**
 * A skeleton's surface, in metres: rings of vertices joined along the edges, which are sorted by the iteration of their birth.
 * `counts[k]` is the number of indices born by iteration k; `stems` holds (born, radius) of each vertex, `nodes` its joint.
 */
export interface Tubes {
  positions: Float32Array
  normals: Float32Array
  stems: Float32Array
  nodes: Uint32Array
  indices: Uint32Array
  counts: Uint32Array
}

type Axis = [number, number, number]

/** Wrap a skeleton in tapered tubes of `sides` sides. Radii below `thinnest` metres are drawn as `thinnest`. */
export function tubes(grown: Grown, sides = 5, thinnest = 0): Tubes {
  const heirs = heirsOf(grown)
  const rings = new Rings(grown, sides, thinnest, ringCount(grown, heirs))
  const starts = new Uint32Array(grown.parents.length)
  for (let node = 0; node < grown.parents.length; node++) {
    const parent = grown.parents[node]!
    const steers = parent < 0 || heirs[parent] === node
    starts[node] = steers ? Math.max(parent, 0) : rings.branch(node)
    rings.joint(node, heirs[node]!)
  }
  return { ...rings.vertices(), ...joined(grown, starts, sides) }
}

/** Each joint's thickest child, which its tube runs on into, or -1. */
function heirsOf({ parents, radii }: Grown): Int32Array {
  const heirs = new Int32Array(parents.length).fill(-1)
  for (let node = 0; node < parents.length; node++) {
    const parent = parents[node]!
    if (parent < 0) continue
    const rival = heirs[parent]!
    if (rival < 0 || radii[node]! > radii[rival]!) heirs[parent] = node
  }
  return heirs
}

/** A ring for each joint, and one more where a side branch leaves. */
function ringCount({ parents }: Grown, heirs: Int32Array): number {
  let count = parents.length
  for (let node = 0; node < parents.length; node++) {
    const parent = parents[node]!
    if (parent >= 0 && heirs[parent] !== node) count++
  }
  return count
}

/** Indices of the edges from ring `starts[node]` to ring `node`, in the order of birth. */
function joined({ parents, born }: Grown, starts: Uint32Array, sides: number): Pick<Tubes, 'indices' | 'counts'> {
  const counts = bornBy(parents, born, sides * 6)
  const indices = new Uint32Array(counts[counts.length - 1]!)
  const next = new Uint32Array(counts.length)
  next.set(counts.subarray(0, -1), 1)
  for (let node = 0; node < parents.length; node++) {
    if (parents[node]! < 0) continue
    let at = next[born[node]!]!
    for (let side = 0; side < sides; side++) {
      const turn = (side + 1) % sides
      indices[at++] = starts[node]! * sides + side
      indices[at++] = starts[node]! * sides + turn
      indices[at++] = node * sides + side
      indices[at++] = starts[node]! * sides + turn
      indices[at++] = node * sides + turn
      indices[at++] = node * sides + side
    }
    next[born[node]!] = at
  }
  return { indices, counts }
}

/** How many indices are born by each iteration. */
function bornBy(parents: number[], born: number[], perEdge: number): Uint32Array {
  let last = 0
  for (const iteration of born) last = Math.max(last, iteration)
  const counts = new Uint32Array(last + 1)
  for (let node = 0; node < parents.length; node++) if (parents[node]! >= 0) counts[born[node]!]! += perEdge
  for (let iteration = 1; iteration <= last; iteration++) counts[iteration]! += counts[iteration - 1]!
  return counts
}

/** Writes rings of vertices; joint i's ring is the i-th, those of side branches follow. */
class Rings {
  private readonly positions: Float32Array
  private readonly normals: Float32Array
  private readonly stems: Float32Array
  private readonly nodes: Uint32Array
  private readonly across: Float32Array
  private readonly cos: Float64Array
  private readonly sin: Float64Array
  private extra: number

  constructor(
    private readonly grown: Grown,
    sides: number,
    private readonly thinnest: number,
    rings: number,
  ) {
    const turn = (side: number) => (side / sides) * 2 * Math.PI
    this.cos = Float64Array.from({ length: sides }, (_, side) => Math.cos(turn(side)))
    this.sin = Float64Array.from({ length: sides }, (_, side) => Math.sin(turn(side)))
    this.positions = new Float32Array(rings * sides * 3)
    this.normals = new Float32Array(rings * sides * 3)
    this.stems = new Float32Array(rings * sides * 2)
    this.nodes = new Uint32Array(rings * sides)
    this.across = new Float32Array(grown.parents.length * 3)
    this.extra = grown.parents.length
  }

  /** The ring at a joint, halfway between the edge that comes and the edge to its heir. */
  joint(node: number, heir: number): void {
    const comes: Axis = this.direction(node)
    const goes: Axis = heir < 0 ? comes : this.direction(heir)
    const axis = unit([comes[0] + goes[0], comes[1] + goes[1], comes[2] + goes[2]], comes)
    this.ring(node, node, node, axis)
  }

  /** The ring with which a side branch leaves its parent; gives its number. */
  branch(node: number): number {
    this.ring(this.extra, this.grown.parents[node]!, node, this.direction(node))
    return this.extra++
  }

  vertices(): Pick<Tubes, 'positions' | 'normals' | 'stems' | 'nodes'> {
    return { positions: this.positions, normals: this.normals, stems: this.stems, nodes: this.nodes }
  }

  private direction(node: number): Axis {
    const parent = this.grown.parents[node]!
    if (parent < 0) return [0, 1, 0]
    const [from, to] = [this.grown.points[parent]!, this.grown.points[node]!]
    return unit([to[0] - from[0], to[1] - from[1], to[2] - from[2]], [0, 1, 0])
  }

  private ring(ring: number, at: number, node: number, axis: Axis): void {
    const u = this.acrossOf(node, axis)
    const v = cross(axis, u)
    const middle = this.grown.points[at]!
    const born = this.grown.born[node]!
    const radius = Math.max(this.grown.radii[node]!, this.thinnest)
    const sides = this.cos.length
    for (let side = 0; side < sides; side++) {
      const vertex = ring * sides + side
      for (let part = 0; part < 3; part++) {
        const normal = this.cos[side]! * u[part]! + this.sin[side]! * v[part]!
        this.normals[vertex * 3 + part] = normal
        this.positions[vertex * 3 + part] = middle[part]! + radius * normal
      }
      this.stems[vertex * 2] = born
      this.stems[vertex * 2 + 1] = radius
      this.nodes[vertex] = node
    }
  }

  /** A direction across the axis, carried on from the parent so that tubes do not twist. */
  private acrossOf(node: number, axis: Axis): Axis {
    const parent = this.grown.parents[node]!
    const carried: Axis =
      parent < 0 ? [1, 0, 0] : [this.across[parent * 3]!, this.across[parent * 3 + 1]!, this.across[parent * 3 + 2]!]
    const along = carried[0] * axis[0] + carried[1] * axis[1] + carried[2] * axis[2]
    const other: Axis = Math.abs(axis[2]) < 0.9 ? [axis[1], -axis[0], 0] : [0, axis[2], -axis[1]]
    const across = unit(
      [carried[0] - along * axis[0], carried[1] - along * axis[1], carried[2] - along * axis[2]],
      unit(other, [1, 0, 0]),
    )
    this.across.set(across, node * 3)
    return across
  }
}

function unit(way: Axis, otherwise: Axis): Axis {
  const length = Math.sqrt(way[0] * way[0] + way[1] * way[1] + way[2] * way[2])
  return length < 1e-6 ? otherwise : [way[0] / length, way[1] / length, way[2] / length]
}

function cross(a: Axis, b: Axis): Axis {
  return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}
