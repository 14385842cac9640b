import {
  Box3,
  BufferAttribute,
  Mesh,
  MeshDepthMaterial,
  type MeshStandardMaterial,
  type Object3D,
  type Texture,
} from 'three'
import type { PhotoFrame } from '../api/types'
import { type Box, unitsPerMetre } from './camera'
import { canopyOf, lightAt } from './canopy'
import { type Content, disposeMesh, placed, trianglesOf } from './content'
import { readGlb } from './reading'
import { restingVertices, takeIn } from './resting'
import { barkMaterial, leafMaterial, type Shades } from './shading'
import { SUN } from './sun'
import { Sway } from './sway'
import { joinTwigs } from './twigs'

/** A photo taken at dusk gives dark leaves; their mean brightness (linear, 0..1) is brought halfway to this. */
const DAYLIGHT = 0.2

/** Read a GLB of the service and light its bark and leaves for the preview. `edges`: whether the canvas is antialiased. */
export async function modelContent(glb: ArrayBuffer, shades: Shades, edges: boolean): Promise<Content> {
  const { scene, animations } = await readGlb(glb)
  scene.updateMatrixWorld(true)
  const meshes = joinTwigs(meshesOf(scene))
  const resting = new Map(meshes.map(mesh => [mesh, restingVertices(mesh)]))
  const leaves = meshes.find(mesh => standard(mesh).name === 'leaf') ?? null
  const crown = canopyOf(resting.get(leaves ?? meshes[0]!)!, SUN)
  for (const [mesh, vertices] of resting) dress(mesh, lightAt(crown, vertices), { shades, edges })
  const photo = scene.userData.photo as PhotoFrame
  const sway = animations.length ? new Sway(scene, animations) : null
  return {
    kind: 'model',
    group: placed(photo, scene),
    photo,
    box: boxAround(resting.values(), unitsPerMetre(photo)),
    triangles: meshes.reduce((sum, mesh) => sum + trianglesOf(mesh.geometry), 0),
    leaves,
    sway,
    age: share => {
      shades.leafed.value = share
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

/** The box around vertices in metres, in units of the preview's world. */
function boxAround(parts: Iterable<Float32Array>, units: number): Box {
  const box = new Box3()
  for (const vertices of parts) takeIn(box, vertices)
  const [min, max] = [box.min.multiplyScalar(units), box.max.multiplyScalar(units)]
  return { min: [min.x, min.y, min.z], max: [max.x, max.y, max.z] }
}

/** Replace a mesh's material by the preview's own, and give it the canopy's light, two bytes a vertex. */
function dress(mesh: Mesh, light: Uint8Array, { shades, edges }: { shades: Shades; edges: boolean }): void {
  const given = standard(mesh)
  const gain = given.map ? gainOf(brightnessOf(given.map)) : 1
  for (const texture of [given.map, given.normalMap]) if (texture) texture.anisotropy = 4
  const look = { cut: given.alphaTest, gain }
  const material = given.name === 'leaf' ? leafMaterial(given.map, look, shades) : barkMaterial(given, gain, shades)
  material.alphaToCoverage = edges && look.cut > 0
  given.dispose()
  mesh.material = material
  mesh.geometry.setAttribute('light', new BufferAttribute(light, 2, true))
  mesh.customDepthMaterial = new MeshDepthMaterial()
  mesh.castShadow = true
  mesh.receiveShadow = true
  // A tree is looked at as a whole; to find out where wind has blown it takes longer than to draw it.
  mesh.frustumCulled = false
}

/** How much brighter a texture of this mean brightness is drawn. */
export function gainOf(brightness: number): number {
  return Math.min(Math.max((DAYLIGHT / Math.max(brightness, 1e-3)) ** 0.5, 1), 4)
}

/** The mean brightness (linear, 0..1) of a texture's opaque pixels. */
function brightnessOf(texture: Texture): number {
  const canvas = new OffscreenCanvas(32, 32)
  const pen = canvas.getContext('2d')!
  pen.drawImage(texture.image as ImageBitmap, 0, 0, 32, 32)
  const { data: rgba } = pen.getImageData(0, 0, 32, 32)
  let [sum, count] = [0, 0]
  for (let at = 0; at < rgba.length; at += 4) {
    if (rgba[at + 3]! < 128) continue
    sum += (0.3 * rgba[at]! + 0.6 * rgba[at + 1]! + 0.1 * rgba[at + 2]!) / 255
    count++
  }
  return (sum / Math.max(count, 1)) ** 2.2
}

function standard(mesh: Mesh): MeshStandardMaterial {
  return mesh.material as MeshStandardMaterial
}
