import { BufferAttribute, BufferGeometry, Color, Mesh } from 'three'
import type { Grown } from '../api/types'
import { canopyOf, lightAt } from './canopy'
import { boxOf, type Content, disposeMesh, placed, trianglesOf } from './content'
import { type Shades, THICKENING, woodMaterial } from './shading'
import { SUN } from './sun'
import { type Tubes, tubes } from './tubes'

/** Twigs thinner than this share of the photo's height would fall between the pixels. */
const THINNEST = 0.0012
const SEEN = new Color('#6a6350')
const OLD = new Color('#8f7053')
const YOUNG = new Color('#bb9c74')

/** The live skeleton: the photo's own branches in olive, those that grew behind them in warm wood. */
export function skeletonContent(grown: Grown, shades: Shades): Content {
  const { photo } = grown
  const tube = tubes(grown, 5, THINNEST * photo.metres_per_pixel * photo.height)
  const mesh = new Mesh(geometryOf(grown, tube), woodMaterial(shades))
  mesh.castShadow = true
  mesh.receiveShadow = true
  const group = placed(photo, mesh)
  return {
    kind: 'live',
    group,
    photo,
    box: boxOf(group),
    triangles: trianglesOf(mesh.geometry),
    leaves: null,
    sway: null,
    age: share => growTo(mesh, tube, shades, share),
    dispose: () => disposeMesh(mesh),
  }
}

/** Show the branches born within this share of the growth. */
function growTo(mesh: Mesh, tube: Tubes, shades: Shades, share: number): void {
  const last = tube.counts.length - 1
  shades.age.value = share * (last + THICKENING)
  mesh.geometry.setDrawRange(0, tube.counts[Math.min(Math.floor(shades.age.value), last)]!)
}

function geometryOf(grown: Grown, tube: Tubes): BufferGeometry {
  const geometry = new BufferGeometry()
  geometry.setAttribute('position', new BufferAttribute(tube.positions, 3))
  geometry.setAttribute('normal', new BufferAttribute(tube.normals, 3))
  geometry.setAttribute('stem', new BufferAttribute(tube.stems, 2))
  geometry.setAttribute('color', new BufferAttribute(coloursOf(tube), 3))
  const joints = Float32Array.from(grown.points.flat())
  const light = lightAt(canopyOf(joints, SUN), joints)
  geometry.setAttribute('light', new BufferAttribute(spread(light, tube.nodes), 2, true))
  geometry.setIndex(new BufferAttribute(tube.indices, 1))
  return geometry
}

/** Each vertex gets its joint's two bytes. */
function spread(light: Uint8Array, nodes: Uint32Array): Uint8Array {
  const all = new Uint8Array(nodes.length * 2)
  for (let vertex = 0; vertex < nodes.length; vertex++) {
    all[vertex * 2] = light[nodes[vertex]! * 2]!
    all[vertex * 2 + 1] = light[nodes[vertex]! * 2 + 1]!
  }
  return all
}

function coloursOf({ stems, counts }: Tubes): Float32Array {
  const colours = new Float32Array((stems.length / 2) * 3)
  const shade = new Color()
  for (let vertex = 0; vertex * 2 < stems.length; vertex++) {
    const born = stems[vertex * 2]!
    if (born === 0) shade.copy(SEEN)
    else shade.lerpColors(OLD, YOUNG, born / counts.length)
    shade.toArray(colours, vertex * 3)
  }
  return colours
}
