import { BufferAttribute, BufferGeometry, Color, Mesh } from 'three'
import type { Grown } from '../api/types'
import { canopyOf, lightAt } from './canopy'
import { boxOf, type Content, disposeMesh, placeInWorld, trianglesOf } from './content'
import { THICKENING, type TreeUniforms, woodMaterial } from './shading'
import { SUN } from './sun'
import { type Tubes, tubes } from './tubes'

/** The thinnest drawn radius, as a share of the photo's height: thinner twigs would be lost between pixels. */
const THINNEST = 0.0012
const VISIBLE = new Color('#6a6350')
const OLD = new Color('#8f7053')
const YOUNG = new Color('#bb9c74')

/** Return a live tree: its visible branches in olive, those that were grown in warm browns. */
export function liveTreeContent(grown: Grown, uniforms: TreeUniforms): Content {
  const { photo } = grown
  const tube = tubes(grown, 5, THINNEST * photo.metres_per_pixel * photo.height)
  const mesh = new Mesh(geometryOf(grown, tube), woodMaterial(uniforms))
  mesh.castShadow = true
  mesh.receiveShadow = true
  const group = placeInWorld(photo, mesh)
  return {
    kind: 'live',
    group,
    photo,
    box: boxOf(group),
    triangles: trianglesOf(mesh.geometry),
    leaves: null,
    sway: null,
    motion: null,
    showGrowth: share => showGrowth(mesh, tube, uniforms, share),
    dispose: () => disposeMesh(mesh),
  }
}

/** Show the branches born within a share of the growth, 0..1. */
function showGrowth(mesh: Mesh, tube: Tubes, uniforms: TreeUniforms, share: number): void {
  const last = tube.counts.length - 1
  uniforms.iteration.value = share * (last + THICKENING)
  mesh.geometry.setDrawRange(0, tube.counts[Math.min(Math.floor(uniforms.iteration.value), last)]!)
}

function geometryOf(grown: Grown, tube: Tubes): BufferGeometry {
  const geometry = new BufferGeometry()
  geometry.setAttribute('position', new BufferAttribute(tube.positions, 3))
  geometry.setAttribute('normal', new BufferAttribute(tube.normals, 3))
  geometry.setAttribute('bornRadius', new BufferAttribute(tube.bornRadii, 2))
  geometry.setAttribute('color', new BufferAttribute(coloursOf(tube), 3))
  const joints = Float32Array.from(grown.points.flat())
  const light = lightAt(canopyOf(joints, SUN), joints)
  geometry.setAttribute('light', new BufferAttribute(perVertex(light, tube.joints), 2, true))
  geometry.setIndex(new BufferAttribute(tube.indices, 1))
  return geometry
}

/** Return the two bytes of each vertex's joint. */
function perVertex(light: Uint8Array, joints: Uint32Array): Uint8Array {
  const all = new Uint8Array(joints.length * 2)
  for (let vertex = 0; vertex < joints.length; vertex++) {
    all[vertex * 2] = light[joints[vertex]! * 2]!
    all[vertex * 2 + 1] = light[joints[vertex]! * 2 + 1]!
  }
  return all
}

function coloursOf({ bornRadii, counts }: Tubes): Float32Array {
  const colours = new Float32Array((bornRadii.length / 2) * 3)
  const colour = new Color()
  for (let vertex = 0; vertex * 2 < bornRadii.length; vertex++) {
    const born = bornRadii[vertex * 2]!
    if (born === 0) colour.copy(VISIBLE)
    else colour.lerpColors(OLD, YOUNG, born / counts.length)
    colour.toArray(colours, vertex * 3)
  }
  return colours
}
