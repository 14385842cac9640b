import {
  BufferAttribute,
  BufferGeometry,
  Color,
  DoubleSide,
  Mesh,
  MeshLambertMaterial,
  Points,
  PointsMaterial,
  SRGBColorSpace,
} from 'three'
import type { Cloud } from '../../api/types'
import type { Branches } from '../../branches'
import type { Vec3 } from '../camera'
import { tubes } from '../tubes'
import type { CrownSurface } from './measured'

/** Size of a point, CSS px. */
const POINT_PX = 2.5
/** The crown's colour and opacity where photos show it, and where it is guessed. */
const MEASURED = { colour: new Color('#4f8f46'), opacity: 0.34 }
const GUESSED = { colour: new Color('#d99a2b'), opacity: 0.28 }
/** The colours of branches that photos show, and of those that only join them. */
const SEEN = new Color('#5f4a35')
const JOINING = new Color('#e0a13c')
/** The thinnest branch that is drawn, as a share of the height that photos show: thinner ones would be lost between pixels. */
const THINNEST = 0.0016

/** Return the points of a cloud that lie no further than `reach` from a point, in their colours. */
export function cloudPoints({ points, colours }: Cloud, about: Vec3, reach: number): Points {
  const near = points.flatMap((point, at) => (distance(point, about) <= reach ? [at] : []))
  const colour = new Color()
  const shown = new Float32Array(near.length * 3)
  near.forEach((at, to) => {
    const [red, green, blue] = colours[at]!
    colour.setRGB(red / 255, green / 255, blue / 255, SRGBColorSpace).toArray(shown, to * 3)
  })
  const geometry = new BufferGeometry()
  geometry.setAttribute('position', new BufferAttribute(Float32Array.from(near.flatMap(at => points[at]!)), 3))
  geometry.setAttribute('color', new BufferAttribute(shown, 3))
  return new Points(
    geometry,
    new PointsMaterial({ size: POINT_PX, sizeAttenuation: false, vertexColors: true, toneMapped: false }),
  )
}

/** Return a crown's surface, which is seen through; its guessed parts have a colour of their own. */
export function crownMesh({ points, triangles, guessed }: CrownSurface): Mesh {
  const colours = new Float32Array(points.length * 4)
  guessed.forEach((guess, at) => {
    const { colour, opacity } = guess ? GUESSED : MEASURED
    colours.set([colour.r, colour.g, colour.b, opacity], at * 4)
  })
  const geometry = new BufferGeometry()
  geometry.setAttribute('position', new BufferAttribute(Float32Array.from(points.flat()), 3))
  geometry.setAttribute('color', new BufferAttribute(colours, 4))
  geometry.setIndex(triangles.flat())
  geometry.computeVertexNormals()
  const look = { vertexColors: true, transparent: true, depthWrite: false, side: DoubleSide }
  return new Mesh(geometry, new MeshLambertMaterial(look))
}

/** Return branches as tubes; those that only join others have a colour of their own. */
export function branchMesh({ points, radii, parents, seen }: Branches, unit: number): Mesh {
  const tube = tubes({ points, radii, parents, born: parents.map(() => 0) }, 5, THINNEST * unit)
  const colours = new Float32Array(tube.joints.length * 3)
  tube.joints.forEach((joint, vertex) => {
    const colour = seen[joint] ? SEEN : JOINING
    colour.toArray(colours, vertex * 3)
  })
  const geometry = new BufferGeometry()
  geometry.setAttribute('position', new BufferAttribute(tube.positions, 3))
  geometry.setAttribute('normal', new BufferAttribute(tube.normals, 3))
  geometry.setAttribute('color', new BufferAttribute(colours, 3))
  geometry.setIndex(new BufferAttribute(tube.indices, 1))
  return new Mesh(geometry, new MeshLambertMaterial({ vertexColors: true }))
}

function distance(one: Vec3, other: Vec3): number {
  return Math.hypot(one[0] - other[0], one[1] - other[1], one[2] - other[2])
}
