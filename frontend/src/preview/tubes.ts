/**
 * A skeleton's surface, in metres: rings of vertices, with triangles along the edges in the order of birth. `counts[k]` is
 * the number of indices born by iteration k; for each vertex, `bornRadii` holds its iteration of birth and its radius
 * (metres), and `joints` the number of its joint.
 */
export interface Tubes {
  positions: Float32Array
  normals: Float32Array
  bornRadii: Float32Array
  joints: Uint32Array
  indices: Uint32Array
  counts: Uint32Array
}

/** What tubes are made around: a skeleton with each joint's iteration of birth. */
export interface Branches {
  readonly points: readonly (readonly [number, number, number])[]
  readonly radii: readonly number[]
  readonly parents: readonly number[]
  readonly born: readonly number[]
}

type Axis = [number, number, number]

/** Return tapered tubes with `sides` sides around a skeleton; no radius is below `thinnest` metres. */
export function tubes(grown: Branches, sides = 5, thinnest = 0): Tubes {
  const continuations = continuationsOf(grown)
  const rings = new Rings(grown, sides, thinnest, ringCount(grown, continuations))
  const starts = new Uint32Array(grown.parents.length)
  for (let joint = 0; joint < grown.parents.length; joint++) {
    const parent = grown.parents[joint]!
    const continues = parent < 0 || continuations[parent] === joint
    starts[joint] = continues ? Math.max(parent, 0) : rings.addBranchStart(joint)
    rings.addJoint(joint, continuations[joint]!)
  }
  return { ...rings.vertices(), ...edgeIndices(grown, starts, sides) }
}

/** Return each joint's thickest child, with which its tube goes on; -1 where there is none. */
function continuationsOf({ parents, radii }: Branches): Int32Array {
  const continuations = new Int32Array(parents.length).fill(-1)
  for (let joint = 0; joint < parents.length; joint++) {
    const parent = parents[joint]!
    if (parent < 0) continue
    const rival = continuations[parent]!
    if (rival < 0 || radii[joint]! > radii[rival]!) continuations[parent] = joint
  }
  return continuations
}

/** Return the number of rings: one for each joint, and one more where a side branch starts. */
function ringCount({ parents }: Branches, continuations: Int32Array): number {
  let count = parents.length
  for (let joint = 0; joint < parents.length; joint++) {
    const parent = parents[joint]!
    if (parent >= 0 && continuations[parent] !== joint) count++
  }
  return count
}

/** Return the indices of the edges from ring `starts[joint]` to ring `joint`, in the order of birth. */
function edgeIndices(
  { parents, born }: Branches,
  starts: Uint32Array,
  sides: number,
): Pick<Tubes, 'indices' | 'counts'> {
  const counts = indexCounts(parents, born, sides * 6)
  const indices = new Uint32Array(counts[counts.length - 1]!)
  const next = new Uint32Array(counts.length)
  next.set(counts.subarray(0, -1), 1)
  for (let joint = 0; joint < parents.length; joint++) {
    if (parents[joint]! < 0) continue
    let at = next[born[joint]!]!
    for (let side = 0; side < sides; side++) {
      const nextSide = (side + 1) % sides
      indices[at++] = starts[joint]! * sides + side
      indices[at++] = starts[joint]! * sides + nextSide
      indices[at++] = joint * sides + side
      indices[at++] = starts[joint]! * sides + nextSide
      indices[at++] = joint * sides + nextSide
      indices[at++] = joint * sides + side
    }
    next[born[joint]!] = at
  }
  return { indices, counts }
}

/** Return how many indices are born by each iteration. */
function indexCounts(parents: readonly number[], born: readonly number[], perEdge: number): Uint32Array {
  let last = 0
  for (const iteration of born) last = Math.max(last, iteration)
  const counts = new Uint32Array(last + 1)
  for (let joint = 0; joint < parents.length; joint++) if (parents[joint]! >= 0) counts[born[joint]!]! += perEdge
  for (let iteration = 1; iteration <= last; iteration++) counts[iteration]! += counts[iteration - 1]!
  return counts
}

/** Writes rings of vertices; the i-th is that of joint i, the starts of side branches follow. */
class Rings {
  private readonly positions: Float32Array
  private readonly normals: Float32Array
  private readonly bornRadii: Float32Array
  private readonly joints: Uint32Array
  private readonly across: Float32Array
  private readonly cos: Float64Array
  private readonly sin: Float64Array
  /** The number of the next side branch's first ring. */
  private nextStart: number

  constructor(
    private readonly grown: Branches,
    sides: number,
    private readonly thinnest: number,
    rings: number,
  ) {
    const turn = (side: number) => (side / sides) * 2 * Math.PI
    this.cos = Float64Array.from({ length: sides }, (_, side) => Math.cos(turn(side)))
    this.sin = Float64Array.from({ length: sides }, (_, side) => Math.sin(turn(side)))
    this.positions = new Float32Array(rings * sides * 3)
    this.normals = new Float32Array(rings * sides * 3)
    this.bornRadii = new Float32Array(rings * sides * 2)
    this.joints = new Uint32Array(rings * sides)
    this.across = new Float32Array(grown.parents.length * 3)
    this.nextStart = grown.parents.length
  }

  /** Add a joint's ring, at an angle halfway between its edge and the next one. */
  addJoint(joint: number, continuation: number): void {
    const edge: Axis = this.direction(joint)
    const next: Axis = continuation < 0 ? edge : this.direction(continuation)
    const axis = unit([edge[0] + next[0], edge[1] + next[1], edge[2] + next[2]], edge)
    this.write(joint, joint, joint, axis)
  }

  /** Add the ring with which a side branch leaves its parent; returns the ring's number. */
  addBranchStart(joint: number): number {
    this.write(this.nextStart, this.grown.parents[joint]!, joint, this.direction(joint))
    return this.nextStart++
  }

  vertices(): Pick<Tubes, 'positions' | 'normals' | 'bornRadii' | 'joints'> {
    return { positions: this.positions, normals: this.normals, bornRadii: this.bornRadii, joints: this.joints }
  }

  /** Return the unit direction from a joint's parent to the joint; up for a root. */
  private direction(joint: number): Axis {
    const parent = this.grown.parents[joint]!
    if (parent < 0) return [0, 1, 0]
    const [from, to] = [this.grown.points[parent]!, this.grown.points[joint]!]
    return unit([to[0] - from[0], to[1] - from[1], to[2] - from[2]], [0, 1, 0])
  }

  /** Write a ring around joint `at` with the radius and birth of `joint`. */
  private write(ring: number, at: number, joint: number, axis: Axis): void {
    const u = this.acrossOf(joint, axis)
    const v = cross(axis, u)
    const middle = this.grown.points[at]!
    const born = this.grown.born[joint]!
    const radius = Math.max(this.grown.radii[joint]!, this.thinnest)
    const sides = this.cos.length
    for (let side = 0; side < sides; side++) {
      const vertex = ring * sides + side
      for (let part = 0; part < 3; part++) {
        const normal = this.cos[side]! * u[part]! + this.sin[side]! * v[part]!
        this.normals[vertex * 3 + part] = normal
        this.positions[vertex * 3 + part] = middle[part]! + radius * normal
      }
      this.bornRadii[vertex * 2] = born
      this.bornRadii[vertex * 2 + 1] = radius
      this.joints[vertex] = joint
    }
  }

  /** Return a direction across the axis, as near to the parent's as can be, so that tubes do not twist. */
  private acrossOf(joint: number, axis: Axis): Axis {
    const parent = this.grown.parents[joint]!
    const carried: Axis =
      parent < 0 ? [1, 0, 0] : [this.across[parent * 3]!, this.across[parent * 3 + 1]!, this.across[parent * 3 + 2]!]
    const along = carried[0] * axis[0] + carried[1] * axis[1] + carried[2] * axis[2]
    const other: Axis = Math.abs(axis[2]) < 0.9 ? [axis[1], -axis[0], 0] : [0, axis[2], -axis[1]]
    const across = unit(
      [carried[0] - along * axis[0], carried[1] - along * axis[1], carried[2] - along * axis[2]],
      unit(other, [1, 0, 0]),
    )
    this.across.set(across, joint * 3)
    return across
  }
}

/** Return a vector of length 1, or `fallback` where it has none. */
function unit(vector: Axis, fallback: Axis): Axis {
  const length = Math.sqrt(vector[0] * vector[0] + vector[1] * vector[1] + vector[2] * vector[2])
  return length < 1e-6 ? fallback : [vector[0] / length, vector[1] / length, vector[2] / length]
}

function cross(a: Axis, b: Axis): Axis {
  return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}
