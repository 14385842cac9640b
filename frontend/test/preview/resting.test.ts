import { Bone, Box3, BufferAttribute, BufferGeometry, Matrix4, Mesh, Skeleton, SkinnedMesh } from 'three'
import { expect, test } from 'vitest'
import { expandBox, restingVertices } from '../../src/preview/resting'

/** Three corners of a box, quantized to 16 bits. */
function quantized(): BufferGeometry {
  const geometry = new BufferGeometry()
  geometry.setAttribute('position', new BufferAttribute(new Int16Array([0, 0, 0, 32767, 0, 0, 0, -32767, 0]), 3, true))
  return geometry
}

function skinned(): SkinnedMesh {
  const mesh = new SkinnedMesh(quantized())
  const root = new Bone()
  const branch = new Bone()
  branch.position.set(0, 3, 0)
  root.add(branch)
  mesh.add(root)
  mesh.updateMatrixWorld(true)
  // The bones undo the quantization: 4 m for each unit.
  const inverse = (bone: Bone) =>
    bone.matrixWorld
      .clone()
      .invert()
      .multiply(new Matrix4().makeScale(4, 4, 4))
  mesh.bind(new Skeleton([root, branch], [inverse(root), inverse(branch)]), new Matrix4())
  return mesh
}

test('quantized vertices lie where their mesh puts them', () => {
  const mesh = new Mesh(quantized())
  mesh.scale.setScalar(2)
  mesh.position.set(0, 1, 0)
  mesh.updateMatrixWorld(true)
  expect([...restingVertices(mesh)]).toEqual([0, 1, 0, 2, 1, 0, 0, -1, 0])
})

test('vertices on bones lie in the rest pose, in any wind', () => {
  const mesh = skinned()
  const still = [...restingVertices(mesh)]
  mesh.skeleton.bones[1]!.rotation.z = 1
  mesh.updateMatrixWorld(true)
  expect(still).toEqual([0, 0, 0, 4, 0, 0, 0, -4, 0])
  expect([...restingVertices(mesh)]).toEqual(still)
})

test('a box expands to contain vertices', () => {
  const box = new Box3()
  expandBox(box, restingVertices(skinned()))
  expect([box.min.toArray(), box.max.toArray()]).toEqual([
    [0, -4, 0],
    [4, 0, 0],
  ])
})
