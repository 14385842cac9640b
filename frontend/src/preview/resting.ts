import { type Box3, Matrix4, type Mesh, SkinnedMesh, Vector3 } from 'three'

/** What takes a mesh's vertices to where they rest in the world, whatever the wind does: its first bone never turns. */
export function restMatrix(mesh: Mesh): Matrix4 {
  if (!(mesh instanceof SkinnedMesh)) return mesh.matrixWorld
  const { bones, boneInverses } = mesh.skeleton
  return new Matrix4().multiplyMatrices(bones[0]!.matrixWorld, boneInverses[0]!)
}

/** The vertices of a mesh at rest, in the world: x, y, z each; of packed ones their true places. */
export function restingVertices(mesh: Mesh): Float32Array {
  const position = mesh.geometry.getAttribute('position')
  const rest = restMatrix(mesh)
  const all = new Float32Array(position.count * 3)
  const vertex = new Vector3()
  for (let at = 0; at < position.count; at++)
    vertex
      .fromBufferAttribute(position, at)
      .applyMatrix4(rest)
      .toArray(all, at * 3)
  return all
}

/** Let a box take in vertices, x, y, z each. */
export function takeIn(box: Box3, vertices: Float32Array): void {
  const vertex = new Vector3()
  for (let at = 0; at < vertices.length; at += 3) box.expandByPoint(vertex.fromArray(vertices, at))
}
