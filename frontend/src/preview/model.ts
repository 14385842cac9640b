import {
  Box3,
  BufferAttribute,
  Mesh,
  MeshDepthMaterial,
  type MeshStandardMaterial,
  type Object3D,
  type Texture,
} from 'three'
import type { CameraInfo, PhotoFrame } from '../api/types'
import { type Box, unitsPerMetre } from './camera'
import { canopyOf, lightAt } from './canopy'
import { type Content, disposeMesh, type MotionInfo, placeInWorld, trianglesOf } from './content'
import { readGlb } from './glb'
import { expandBox, restingVertices } from './resting'
import { barkMaterial, leafMaterial, type TreeUniforms } from './shading'
import { SUN } from './sun'
import { Sway } from './sway'
import { joinTwigs } from './twigs'

/** Textures from a dark photo are brightened: their mean (linear, 0..1) is brought halfway to this. */
const DAYLIGHT = 0.2

/** Read a GLB of the service, with materials for the preview; `antialiased` tells whether the canvas is. */
export async function modelContent(glb: ArrayBuffer, uniforms: TreeUniforms, antialiased: boolean): Promise<Content> {
  const { scene, animations } = await readGlb(glb)
  scene.updateMatrixWorld(true)
  const meshes = joinTwigs(meshesOf(scene))
  const resting = new Map(meshes.map(mesh => [mesh, restingVertices(mesh)]))
  const leaves = meshes.find(mesh => materialOf(mesh).name === 'leaf') ?? null
  const crown = canopyOf(resting.get(leaves ?? meshes[0]!)!, SUN)
  for (const [mesh, vertices] of resting) replaceMaterial(mesh, lightAt(crown, vertices), { uniforms, antialiased })
  const photo = scene.userData.photo as PhotoFrame
  const cameras = scene.userData.cameras as readonly CameraInfo[] | undefined
  const sway = animations.length ? new Sway(scene, animations) : null
  return {
    kind: 'model',
    group: placeInWorld(photo, scene),
    photo,
    box: boxAround(resting.values(), unitsPerMetre(photo)),
    triangles: meshes.reduce((sum, mesh) => sum + trianglesOf(mesh.geometry), 0),
    leaves,
    sway,
    motion: (scene.userData.motion as MotionInfo | undefined) ?? null,
    ...(cameras && { cameras }),
    showGrowth: share => {
      uniforms.leafShare.value = share
    },
    dispose: () => {
      sway?.dispose()
      meshes.forEach(disposeMesh)
    },
  }
}

function meshesOf(scene: Object3D): Mesh[] {
  const meshes: Mesh[] = []
  scene.traverse(part => {
    if (part instanceof Mesh) meshes.push(part)
  })
  return meshes
}

/** Return the box around all vertices (x, y, z each, metres) in the preview's world. */
function boxAround(parts: Iterable<Float32Array>, unitsInMetre: number): Box {
  const box = new Box3()
  for (const vertices of parts) expandBox(box, vertices)
  const [min, max] = [box.min.multiplyScalar(unitsInMetre), box.max.multiplyScalar(unitsInMetre)]
  return { min: [min.x, min.y, min.z], max: [max.x, max.y, max.z] }
}

/** Replace a mesh's material by the preview's own, lit by the canopy's light (two bytes a vertex). */
function replaceMaterial(
  mesh: Mesh,
  light: Uint8Array,
  { uniforms, antialiased }: { uniforms: TreeUniforms; antialiased: boolean },
): void {
  const original = materialOf(mesh)
  const gain = original.map ? gainOf(brightnessOf(original.map)) : 1
  for (const texture of [original.map, original.normalMap]) if (texture) texture.anisotropy = 4
  const { alphaTest, map } = original
  const isLeaf = original.name === 'leaf'
  const material = isLeaf ? leafMaterial(map, { alphaTest, gain }, uniforms) : barkMaterial(original, gain, uniforms)
  material.alphaToCoverage = antialiased && alphaTest > 0
  original.dispose()
  mesh.material = material
  mesh.geometry.setAttribute('light', new BufferAttribute(light, 2, true))
  mesh.customDepthMaterial = new MeshDepthMaterial()
  mesh.castShadow = true
  mesh.receiveShadow = true
  // Finding out whether wind has moved it out of view takes longer than drawing it.
  mesh.frustumCulled = false
}

/** Return by what factor to brighten a texture of this mean brightness (linear, 0..1). */
export function gainOf(brightness: number): number {
  return Math.min(Math.max((DAYLIGHT / Math.max(brightness, 1e-3)) ** 0.5, 1), 4)
}

/** Return the mean brightness (linear, 0..1) of a texture's opaque pixels. */
function brightnessOf(texture: Texture): number {
  const canvas = new OffscreenCanvas(32, 32)
  const ctx = canvas.getContext('2d')!
  ctx.drawImage(texture.image as ImageBitmap, 0, 0, 32, 32)
  const { data: rgba } = ctx.getImageData(0, 0, 32, 32)
  let [sum, count] = [0, 0]
  for (let at = 0; at < rgba.length; at += 4) {
    if (rgba[at + 3]! < 128) continue
    sum += (0.3 * rgba[at]! + 0.6 * rgba[at + 1]! + 0.1 * rgba[at + 2]!) / 255
    count++
  }
  return (sum / Math.max(count, 1)) ** 2.2
}

function materialOf(mesh: Mesh): MeshStandardMaterial {
  return mesh.material as MeshStandardMaterial
}
