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
import type { CameraInfo, PhotoFrame } from '../api/types'
import { type Box, unitsPerMetre } from './camera'
import { groundShadow } from './canopy'
import { restMatrix } from './resting'
import { SUN } from './sun'
import type { Sway } from './sway'

/** The motion that was filmed: the animation's first frames are those of the clip, then it leads back to the first. */
export interface MotionInfo {
  readonly frames: number
  readonly frames_per_second: number
}

/** A tree that the preview shows, in the preview's world, where 1 unit is the photo's height. */
export interface Content {
  readonly kind: 'live' | 'model'
  readonly group: Group
  readonly photo: PhotoFrame
  readonly box: Box
  readonly triangles: number
  /** Its leaves; null where it has none. */
  readonly leaves: Mesh | null
  /** Its animations; null where its file has none. */
  readonly sway: Sway | null
  /** What the file says of the motion that was filmed; null where none was. */
  readonly motion: MotionInfo | null
  /** The cameras of the photos that it was measured from, in its own frame, metres; absent for other trees. */
  readonly cameras?: readonly CameraInfo[]
  /** Show it at a share of its growth, 0..1: the branches of the live tree, the leaves of a model. */
  showGrowth(share: number): void
  /** Free what it holds on the GPU. */
  dispose(): void
}

/** Return a group that scales meshes from metres to the preview's world. */
export function placeInWorld(photo: PhotoFrame, ...meshes: Object3D[]): Group {
  const group = new Group()
  group.scale.setScalar(unitsPerMetre(photo))
  group.add(...meshes)
  group.updateMatrixWorld(true)
  return group
}

/** Return a tree's box in the preview's world. */
export function boxOf(group: Group): Box {
  const { min, max } = new Box3().setFromObject(group)
  return { min: [min.x, min.y, min.z], max: [max.x, max.y, max.z] }
}

/** Return how many triangles a geometry has. */
export function trianglesOf(geometry: BufferGeometry): number {
  return (geometry.index?.count ?? geometry.getAttribute('position').count) / 3
}

/** Return the disc of ground under a tree that holds its shadow: centre [x, z] and radius. */
export function groundUnder({ min, max }: Box): { centre: readonly [number, number]; radius: number } {
  const fall = max[1] / SUN[1] / 2
  const centre = [(min[0] + max[0]) / 2 - SUN[0] * fall, (min[2] + max[2]) / 2 - SUN[2] * fall] as const
  return { centre, radius: Math.max(max[0] - min[0], max[2] - min[2]) * 0.75 + fall * 0.8 }
}

/** Return a tree's shadow on its ground as a picture of `side` x `side` bytes, for where no shadow map is drawn. */
export function shadowOf(content: Content, side: number): Uint8Array {
  const vertices: number[] = []
  const vertex = new Vector3()
  content.group.traverseVisible(part => {
    if (!(part instanceof Mesh)) return
    const position = part.geometry.getAttribute('position')
    const rest = restMatrix(part)
    for (let at = 0; at < position.count; at += 2) {
      vertex.fromBufferAttribute(position, at).applyMatrix4(rest)
      vertices.push(vertex.x, vertex.y, vertex.z)
    }
  })
  return groundShadow(vertices, SUN, { ...groundUnder(content.box), side })
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
