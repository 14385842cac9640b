import { type Box3, Matrix4, type Mesh, SkinnedMesh, Vector3 } from 'three'

/** Return the matrix from a mesh's vertices to the world, in its rest pose: that of its first bone, which never turns. */
export function restMatrix(mesh: Mesh): Matrix4 {
  if (!(mesh instanceof SkinnedMesh)) return mesh.matrixWorld
  const { bones, boneInverses } = mesh.skeleton
  return new Matrix4().multiplyMatrices(bones[0]!.matrixWorld, boneInverses[0]!)
}

/** Return a mesh's vertices in the world (x, y, z each, metres), in its rest pose; quantized ones as true positions. */
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

/** Expand a box to contain vertices, x, y, z each. */
export function expandBox(box: Box3, vertices: Float32Array): void {
  const vertex = new Vector3()
  for (let at = 0; at < vertices.length; at += 3) box.expandByPoint(vertex.fromArray(vertices, at))
}
