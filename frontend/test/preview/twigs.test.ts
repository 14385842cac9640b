import { BufferAttribute, BufferGeometry, Group, Mesh, MeshStandardMaterial } from 'three'
import { expect, it } from 'vitest'
import { joinTwigs } from '../../src/preview/twigs'

function triangle(name: string, height: number, tangents: boolean): Mesh {
  const geometry = new BufferGeometry()
  geometry.setAttribute(
    'position',
    new BufferAttribute(new Float32Array([0, height, 0, 1, height, 0, 0, height, 1]), 3),
  )
  geometry.setAttribute('normal', new BufferAttribute(new Int8Array([0, 127, 0, 0, 127, 0, 0, 127, 0]), 3, true))
  if (tangents) geometry.setAttribute('tangent', new BufferAttribute(new Float32Array(12).fill(1), 4))
  geometry.setIndex([0, 1, 2])
  const material = new MeshStandardMaterial()
  material.name = name
  return new Mesh(geometry, material)
}

it('joins twigs to the bark, behind its own vertices and triangles', () => {
  const [bark, twigs, leaf] = [triangle('bark', 1, true), triangle('bark_twigs', 5, false), triangle('leaf', 9, false)]
  const tree = new Group().add(bark, twigs, leaf)
  expect(joinTwigs([bark, twigs, leaf])).toEqual([bark, leaf])
  expect(tree.children).toEqual([bark, leaf])
  const { attributes, index } = bark.geometry
  expect(Array.from({ length: 6 }, (_, at) => attributes.position!.getY(at))).toEqual([1, 1, 1, 5, 5, 5])
  expect([...index!.array]).toEqual([0, 1, 2, 3, 4, 5])
  expect(attributes.normal!.getY(4)).toBeCloseTo(1)
})

it('gives twigs tangents that stand at right angles to their normals', () => {
  const [bark, twigs] = [triangle('bark', 1, true), triangle('bark_twigs', 5, false)]
  joinTwigs([bark, twigs])
  const { normal, tangent } = bark.geometry.attributes
  const across = [0, 1, 2].reduce(
    (sum, column) => sum + normal!.getComponent(4, column) * tangent!.getComponent(4, column),
    0,
  )
  expect(across).toBeCloseTo(0)
  expect(Math.hypot(tangent!.getX(4), tangent!.getY(4), tangent!.getZ(4))).toBeCloseTo(1)
})

it('leaves a tree without twigs as it is', () => {
  const bark = triangle('bark', 1, false)
  const { geometry } = bark
  expect(joinTwigs([bark])).toEqual([bark])
  expect(bark.geometry).toBe(geometry)
})
