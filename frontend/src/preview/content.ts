import {
  Box3,
  type BufferGeometry,
  Group,
  Mesh,
  type MeshLambertMaterial,
  type Object3D,
  SkinnedMesh,
  type Texture,
  Vector3,
} from 'three'
import type { PhotoFrame } from '../api/types'
import { type Box, unitsPerMetre } from './camera'
import { groundShadow } from './canopy'
import { restMatrix } from './resting'
import { SUN } from './sun'
import type { Sway } from './sway'

/** Something the preview shows: a tree in the preview's world, where 1 unit is the photo's height. */
export interface Content {
  readonly kind: 'live' | 'model'
  readonly group: Group
  readonly photo: PhotoFrame
  readonly box: Box
  readonly triangles: number
  /** Where it has leaves of its own. */
  readonly leaves: Mesh | null
  /** Where its file has wind. */
  readonly sway: Sway | null
  /** How old it is, as a share of its growth: branches for the skeleton, leaves for the model. */
  age(share: number): void
  dispose(): void
}

/** Metres to the preview's world. */
export function placed(photo: PhotoFrame, ...meshes: Object3D[]): Group {
  const group = new Group()
  group.scale.setScalar(unitsPerMetre(photo))
  group.add(...meshes)
  group.updateMatrixWorld(true)
  return group
}

/** The tree's box in the preview's world. */
export function boxOf(group: Group): Box {
  const { min, max } = new Box3().setFromObject(group)
  return { min: [min.x, min.y, min.z], max: [max.x, max.y, max.z] }
}

/** Triangles of a geometry. */
export function trianglesOf(geometry: BufferGeometry): number {
  return (geometry.index?.count ?? geometry.getAttribute('position').count) / 3
}

/** The round of ground under a tree that takes in its shadow: centre [x, z] and radius. */
export function groundUnder({ min, max }: Box): { centre: readonly [number, number]; reach: number } {
  const fall = max[1] / SUN[1] / 2
  const centre = [(min[0] + max[0]) / 2 - SUN[0] * fall, (min[2] + max[2]) / 2 - SUN[2] * fall] as const
  return { centre, reach: Math.max(max[0] - min[0], max[2] - min[2]) * 0.75 + fall * 0.8 }
}

/** The content's shadow on its ground as a picture, for where no shadow map is drawn. */
export function shadowOf(content: Content, side: number): Uint8Array {
  const fallen: number[] = []
  const vertex = new Vector3()
  content.group.traverseVisible(part => {
    if (!(part instanceof Mesh)) return
    const position = part.geometry.getAttribute('position')
    const rest = restMatrix(part)
    for (let at = 0; at < position.count; at += 2) {
      vertex.fromBufferAttribute(position, at).applyMatrix4(rest)
      fallen.push(vertex.x, vertex.y, vertex.z)
    }
  })
  return groundShadow(fallen, SUN, { ...groundUnder(content.box), side })
}

/** Free what a mesh holds on the GPU. */
export function disposeMesh(mesh: Mesh): void {
  mesh.geometry.dispose()
  const material = mesh.material as MeshLambertMaterial
  for (const texture of [material.map, material.normalMap]) disposeTexture(texture)
  material.dispose()
  mesh.customDepthMaterial?.dispose()
  if (mesh instanceof SkinnedMesh) mesh.skeleton.dispose()
}

function disposeTexture(texture: Texture | null): void {
  if (texture?.image instanceof ImageBitmap) texture.image.close()
  texture?.dispose()
}
