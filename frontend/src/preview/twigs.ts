import {
  BufferAttribute,
  BufferGeometry,
  type InterleavedBufferAttribute,
  type Mesh,
  type MeshStandardMaterial,
} from 'three'

type Attribute = BufferAttribute | InterleavedBufferAttribute

/** Join twigs, whose file has no relief for them, to the bark: what is drawn at once costs half the calls. */
export function joinTwigs(meshes: readonly Mesh[]): Mesh[] {
  const bark = meshes.find(mesh => nameOf(mesh) === 'bark')
  const twigs = meshes.find(mesh => nameOf(mesh) === 'bark_twigs')
  if (!bark || !twigs) return [...meshes]
  bark.geometry = joined(bark.geometry, twigs.geometry)
  twigs.removeFromParent()
  return meshes.filter(mesh => mesh !== twigs)
}

/** Put one geometry behind another, with the first one's attributes. */
function joined(first: BufferGeometry, second: BufferGeometry): BufferGeometry {
  const whole = new BufferGeometry()
  for (const [name, values] of Object.entries(first.attributes)) {
    const more = second.getAttribute(name) ?? acrossNormals(second)
    whole.setAttribute(name, behind(values, more))
  }
  const { count } = first.getAttribute('position')
  const [ahead, after] = [first.index!, second.index!]
  const corners = new Uint32Array(ahead.count + after.count)
  corners.set(ahead.array)
  for (let at = 0; at < after.count; at++) corners[ahead.count + at] = count + after.getX(at)
  return whole.setIndex(new BufferAttribute(corners, 1))
}

function behind(first: Attribute, second: Attribute): BufferAttribute {
  const { itemSize } = first
  const all = new Float32Array((first.count + second.count) * itemSize)
  let place = 0
  for (const part of [first, second])
    for (let at = 0; at < part.count; at++)
      for (let column = 0; column < itemSize; column++) all[place++] = part.getComponent(at, column)
  return new BufferAttribute(all, itemSize)
}

/** Tangents at right angles to the normals: on twigs nobody sees how relief runs. */
function acrossNormals(geometry: BufferGeometry): BufferAttribute {
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
