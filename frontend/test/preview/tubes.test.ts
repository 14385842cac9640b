import { describe, expect, it } from 'vitest'
import type { Grown } from '../../src/api/types'
import { type Tubes, tubes } from '../../src/preview/tubes'

const photo = { width: 100, height: 100, metres_per_pixel: 0.01, root: [50, 90] as [number, number] }

/** A trunk of three joints, a branch of two that is born later, and a twig that is born before that. */
const FORK: Grown = {
  points: [
    [0, 0, 0],
    [0, 1, 0],
    [0, 2, 0],
    [1, 2, 0],
    [2, 3, 0],
    [0, 3, 1],
  ],
  radii: [0.3, 0.25, 0.2, 0.1, 0.05, 0.02],
  parents: [-1, 0, 1, 1, 3, 2],
  born: [0, 0, 0, 4, 5, 2],
  photo,
}

/** A tree of chains that fork at random, with this many joints. */
function thicket(joints: number): Grown {
  let seed = 7
  const chance = () => {
    seed = (seed * 16807) % 2147483647
    return seed / 2147483647
  }
  const grown: Grown = { points: [[0, 0, 0]], radii: [0.5], parents: [-1], born: [0], photo }
  for (let node = 1; node < joints; node++) {
    const parent = chance() < 0.85 ? node - 1 : Math.floor(chance() * node)
    const [x, y, z] = grown.points[parent]!
    grown.points.push([x + chance() - 0.5, y + chance() * 0.5, z + chance() - 0.5])
    grown.radii.push(grown.radii[parent]! * 0.99)
    grown.parents.push(parent)
    grown.born.push(grown.born[parent]! + Math.floor(chance() * 2))
  }
  return grown
}

type Axis = [number, number, number]

function at(array: Float32Array, vertex: number): Axis {
  return [array[vertex * 3]!, array[vertex * 3 + 1]!, array[vertex * 3 + 2]!]
}

/** The normal, of any length, of a triangle's front. */
function across(corners: Axis[]): Axis {
  const [a, b, c] = corners as [Axis, Axis, Axis]
  const [p, q] = [b, c].map(corner => corner.map((part, axis) => part - a[axis]!)) as [Axis, Axis]
  return [p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0]]
}

function dot(a: Axis, b: Axis): number {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/** The centre of the tube at each of its vertices. */
function centre(tube: Tubes, vertex: number): number[] {
  const normal = at(tube.normals, vertex)
  return at(tube.positions, vertex).map((part, axis) => part - normal[axis]! * tube.bornRadii[vertex * 2 + 1]!)
}

describe.each([
  ['the fork', FORK],
  ['a thicket', thicket(400)],
])('the tubes of %s', (_, grown) => {
  const sides = 5
  const tube = tubes(grown, sides)

  it('have two triangles a side for every edge', () => {
    expect(tube.indices.length).toBe((grown.parents.length - 1) * sides * 6)
  })

  it('refer only to vertices that exist, and have one joint for each', () => {
    expect(Math.max(...tube.indices)).toBeLessThan(tube.positions.length / 3)
    expect(tube.joints.length * 3).toBe(tube.positions.length)
  })

  it('have unit normals', () => {
    for (let vertex = 0; vertex < tube.joints.length; vertex++)
      expect(Math.hypot(...at(tube.normals, vertex))).toBeCloseTo(1, 5)
  })

  it("lie round the skeleton's joints with their radii", () => {
    for (let vertex = 0; vertex < tube.joints.length; vertex++) {
      const node = tube.joints[vertex]!
      const middle = centre(tube, vertex)
      const away = [node, grown.parents[node]!]
        .filter(joint => joint >= 0)
        .map(joint => Math.hypot(...grown.points[joint]!.map((part, axis) => part - middle[axis]!)))
      expect(Math.min(...away)).toBeLessThan(1e-5)
      expect(tube.bornRadii[vertex * 2 + 1]).toBeCloseTo(grown.radii[node]!, 6)
    }
  })

  it('draw exactly what is born by each iteration', () => {
    tube.counts.forEach((count, iteration) => {
      const edges = grown.parents.filter((parent, node) => parent >= 0 && grown.born[node]! <= iteration)
      expect(count).toBe(edges.length * sides * 6)
      const drawn = Array.from(tube.indices.subarray(0, count), vertex => grown.born[tube.joints[vertex]!]!)
      expect(Math.max(0, ...drawn)).toBeLessThanOrEqual(iteration)
    })
  })
})

it('turns its faces outwards', () => {
  const tube = tubes(FORK, 6)
  for (let first = 0; first < tube.indices.length; first += 3) {
    const corners = [...tube.indices.subarray(first, first + 3)]
    const face = across(corners.map(corner => at(tube.positions, corner)))
    for (const corner of corners) expect(dot(face, at(tube.normals, corner))).toBeGreaterThan(0)
  }
})

it('starts a side branch with its own thickness, not with that of its parent', () => {
  const tube = tubes(FORK, 5)
  const radii = Array.from(tube.joints, (node, vertex) => (node === 3 ? tube.bornRadii[vertex * 2 + 1]! : 0))
  expect(Math.max(...radii)).toBeCloseTo(0.1, 6)
  expect(radii.filter(radius => radius > 0)).toHaveLength(10)
})

it('draws no twig thinner than the limit', () => {
  const { bornRadii } = tubes(FORK, 5, 0.08)
  expect(Math.min(...bornRadii.filter((_, place) => place % 2 === 1))).toBeCloseTo(0.08, 6)
})

it('has no triangles for a lone root', () => {
  const lone = tubes({ points: [[0, 0, 0]], radii: [1], parents: [-1], born: [0] })
  expect(lone.indices).toHaveLength(0)
  expect([...lone.counts]).toEqual([0])
})

it('wraps 10,000 joints in a fraction of a second', () => {
  const grown = thicket(10_000)
  tubes(grown)
  const start = performance.now()
  tubes(grown)
  expect(performance.now() - start).toBeLessThan(300)
})
