import { Bone, Box3, BufferAttribute, BufferGeometry, Matrix4, Mesh, Skeleton, SkinnedMesh } from 'three'
import { expect, test } from 'vitest'
import { restingVertices, takeIn } from '../../src/preview/resting'

/** Packed to 16 bits: three corners of a box. */
function packed(): BufferGeometry {
  const geometry = new BufferGeometry()
  geometry.setAttribute('position', new BufferAttribute(new Int16Array([0, 0, 0, 32767, 0, 0, 0, -32767, 0]), 3, true))
  return geometry
}

function skinned(): SkinnedMesh {
  const mesh = new SkinnedMesh(packed())
  const root = new Bone()
  const branch = new Bone()
  branch.position.set(0, 3, 0)
  root.add(branch)
  mesh.add(root)
  mesh.updateMatrixWorld(true)
  // The packing is undone by the bones: 4 m for each unit.
  const inverse = (bone: Bone) =>
    bone.matrixWorld
      .clone()
      .invert()
      .multiply(new Matrix4().makeScale(4, 4, 4))
  mesh.bind(new Skeleton([root, branch], [inverse(root), inverse(branch)]), new Matrix4())
  return mesh
}

test('packed vertices lie where their mesh puts them', () => {
  const mesh = new Mesh(packed())
  mesh.scale.setScalar(2)
  mesh.position.set(0, 1, 0)
  mesh.updateMatrixWorld(true)
  expect([...restingVertices(mesh)]).toEqual([0, 1, 0, 2, 1, 0, 0, -1, 0])
})

test('vertices on bones lie where these put them, in any wind', () => {
  const mesh = skinned()
  const still = [...restingVertices(mesh)]
  mesh.skeleton.bones[1]!.rotation.z = 1
  mesh.updateMatrixWorld(true)
  expect(still).toEqual([0, 0, 0, 4, 0, 0, 0, -4, 0])
  expect([...restingVertices(mesh)]).toEqual(still)
})

test('a box takes vertices in', () => {
  const box = new Box3()
  takeIn(box, restingVertices(skinned()))
  expect([box.min.toArray(), box.max.toArray()]).toEqual([
    [0, -4, 0],
    [4, 0, 0],
  ])
})
