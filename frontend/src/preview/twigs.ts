import {
  BufferAttribute,
  BufferGeometry,
  type InterleavedBufferAttribute,
  type Mesh,
  type MeshStandardMaterial,
} from 'three'

type Attribute = BufferAttribute | InterleavedBufferAttribute

/** Join the twigs' mesh to the bark's, which halves the draw calls; returns the meshes that are left. */
export function joinTwigs(meshes: readonly Mesh[]): Mesh[] {
  const bark = meshes.find(mesh => nameOf(mesh) === 'bark')
  const twigs = meshes.find(mesh => nameOf(mesh) === 'bark_twigs')
  if (!bark || !twigs) return [...meshes]
  bark.geometry = concatenated(bark.geometry, twigs.geometry)
  twigs.removeFromParent()
  return meshes.filter(mesh => mesh !== twigs)
}

/** Return one geometry with the second one's vertices after the first one's, and the first one's attributes. */
function concatenated(first: BufferGeometry, second: BufferGeometry): BufferGeometry {
  const joined = new BufferGeometry()
  for (const [name, values] of Object.entries(first.attributes)) {
    const more = second.getAttribute(name) ?? tangentsOf(second)
    joined.setAttribute(name, concatenatedValues(values, more))
  }
  const { count } = first.getAttribute('position')
  const [firstIndex, secondIndex] = [first.index!, second.index!]
  const indices = new Uint32Array(firstIndex.count + secondIndex.count)
  indices.set(firstIndex.array)
  for (let at = 0; at < secondIndex.count; at++) indices[firstIndex.count + at] = count + secondIndex.getX(at)
  return joined.setIndex(new BufferAttribute(indices, 1))
}

function concatenatedValues(first: Attribute, second: Attribute): BufferAttribute {
  const { itemSize } = first
  const all = new Float32Array((first.count + second.count) * itemSize)
  let place = 0
  for (const part of [first, second])
    for (let at = 0; at < part.count; at++)
      for (let column = 0; column < itemSize; column++) all[place++] = part.getComponent(at, column)
  return new BufferAttribute(all, itemSize)
}

/** Return some tangents at right angles to the normals: on twigs the direction of the normal map is not visible. */
function tangentsOf(geometry: BufferGeometry): BufferAttribute {
  const normal = geometry.getAttribute('normal')
  const all = new Float32Array(normal.count * 4)
  for (let at = 0; at < normal.count; at++) {
    const [x, y] = [normal.getX(at), normal.getY(at)]
    const length = Math.hypot(x, y)
    all.set(length > 1e-6 ? [-y / length, x / length, 0, 1] : [1, 0, 0, 1], at * 4)
  }
  return new BufferAttribute(all, 4)
}

function nameOf(mesh: Mesh): string {
  return (mesh.material as MeshStandardMaterial).name
}
