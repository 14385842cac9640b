import { type BufferGeometry, type Material, Mesh, type MeshLambertMaterial, Vector3 } from 'three'
import type { Content } from '../content'
import { fewerCards, stillGeometry, thickWood } from './simpler'

/** A part of a tree that is drawn in one call. */
export interface Part {
  readonly geometry: BufferGeometry
  readonly material: Material
}

/** A tree of which a grove has many: its parts by detail, and its size, metres. */
export interface Kind {
  readonly near: readonly Part[]
  readonly middle: readonly Part[]
  readonly height: number
  /** How far its crown reaches from its root. */
  readonly radius: number
  readonly content: Content
}

/** Return a tree as a kind of a grove. */
export function kindOf(content: Content): Kind {
  const meshes: Mesh[] = []
  content.group.traverse(part => {
    if (part instanceof Mesh && part.visible) meshes.push(part)
  })
  // From the preview's world back to metres.
  const scale = 1 / content.group.scale.x
  const near = meshes.map(mesh => partOf(mesh, inMetres(stillGeometry(mesh), scale)))
  const middle = near.map(({ geometry, material }, at) => ({
    geometry: meshes[at] === content.leaves ? fewerCards(geometry) : thickWood(geometry),
    material,
  }))
  const { min, max } = content.box
  const reach = Math.max(...[min[0], max[0], min[2], max[2]].map(Math.abs))
  return { near, middle, height: max[1] * scale, radius: reach * scale, content }
}

function partOf(mesh: Mesh, geometry: BufferGeometry): Part {
  return { geometry, material: mesh.material as MeshLambertMaterial }
}

/** Scale the places of vertices, which no other geometry shares. */
function inMetres(geometry: BufferGeometry, scale: number): BufferGeometry {
  const position = geometry.getAttribute('position')
  const vertex = new Vector3()
  for (let at = 0; at < position.count; at++) {
    vertex.fromBufferAttribute(position, at).multiplyScalar(scale)
    position.setXYZ(at, vertex.x, vertex.y, vertex.z)
  }
  return geometry
}
