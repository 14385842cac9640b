import {
  BufferAttribute,
  type BufferGeometry,
  Mesh,
  MeshDepthMaterial,
  type MeshStandardMaterial,
  type Texture,
} from 'three'
import { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js'
import type { PhotoFrame } from '../state'
import { type Canopy, canopyOf, lightAt } from './canopy'
import { boxOf, type Content, disposeMesh, placed, trianglesOf } from './content'
import { barkMaterial, leafMaterial, type Shades } from './shading'
import { SUN } from './sun'

/** A photo taken at dusk gives dark leaves; their mean brightness (linear, 0..1) is brought halfway to this. */
const DAYLIGHT = 0.2

/** Read a GLB of the service and light its bark and leaves for the preview. `edges`: whether the canvas is antialiased. */
export async function modelContent(glb: ArrayBuffer, shades: Shades, edges: boolean): Promise<Content> {
  const { scene } = await new GLTFLoader().parseAsync(glb, '')
  scene.updateMatrixWorld(true)
  const meshes: Mesh[] = []
  scene.traverse(part => {
    if (part instanceof Mesh) meshes.push(part)
  })
  const leaves = meshes.find(mesh => standard(mesh).name === 'leaf') ?? null
  const crown = canopyOf(verticesOf((leaves ?? meshes[0]!).geometry), SUN)
  for (const mesh of meshes) dress(mesh, { crown, shades, edges })
  const photo = scene.userData.photo as PhotoFrame
  const group = placed(photo, ...meshes)
  return {
    kind: 'model',
    group,
    photo,
    box: boxOf(group),
    triangles: meshes.reduce((sum, mesh) => sum + trianglesOf(mesh.geometry), 0),
    leaves,
    age: share => {
      shades.leafed.value = share
    },
    dispose: () => meshes.forEach(disposeMesh),
  }
}

/** Replace a mesh's material by the preview's own, and give it the canopy's light. */
function dress(mesh: Mesh, { crown, shades, edges }: { crown: Canopy; shades: Shades; edges: boolean }): void {
  const given = standard(mesh)
  const gain = given.map ? gainOf(brightnessOf(given.map)) : 1
  if (given.map) given.map.anisotropy = 4
  const look = { cut: given.alphaTest, gain }
  const material = given.name === 'leaf' ? leafMaterial(given.map, look, shades) : barkMaterial(given.map, gain, shades)
  material.alphaToCoverage = edges && look.cut > 0
  given.dispose()
  mesh.material = material
  mesh.geometry.setAttribute('light', new BufferAttribute(lightAt(crown, verticesOf(mesh.geometry)), 2, true))
  mesh.customDepthMaterial = new MeshDepthMaterial()
  mesh.castShadow = true
  mesh.receiveShadow = true
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

function verticesOf(geometry: BufferGeometry): ArrayLike<number> {
  return geometry.getAttribute('position').array
}
