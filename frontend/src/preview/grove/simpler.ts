import { BufferAttribute, BufferGeometry, type Mesh } from 'three'
import { restingVertices } from '../resting'

/** Of so many leaf cards one stays at a middle distance, larger, so that all of them cover as much. */
const CARDS_TO_ONE = 6
/** The share of the bark's triangles that stay, the largest. */
const BARK_SHARE = 0.2
const CORNERS = 4

/** Return a mesh's geometry in its rest pose, without bones. */
export function stillGeometry(mesh: Mesh): BufferGeometry {
  const still = new BufferGeometry()
  for (const [name, values] of Object.entries(mesh.geometry.attributes))
    if (!name.startsWith('skin')) still.setAttribute(name, values)
  still.setAttribute('position', new BufferAttribute(restingVertices(mesh), 3))
  still.setIndex(mesh.geometry.index)
  return still
}

/** Return leaf cards (four vertices and two triangles each) of which every sixth stays, larger. */
export function fewerCards(cards: BufferGeometry): BufferGeometry {
  const position = cards.getAttribute('position')
  const index = cards.index!
  const kept: number[] = []
  const corners = new Float32Array(position.array.length)
  for (let at = 0; at + 5 < index.count; at += 6 * CARDS_TO_ONE) {
    for (let corner = 0; corner < 6; corner++) kept.push(index.getX(at + corner))
    enlarge(position, Math.floor(index.getX(at) / CORNERS) * CORNERS, corners)
  }
  return withIndex(cards, kept).setAttribute('position', new BufferAttribute(corners, 3))
}

/** Write a card's corners, moved away from their middle, to the same places. */
function enlarge(position: ReturnType<BufferGeometry['getAttribute']>, first: number, corners: Float32Array): void {
  const factor = Math.sqrt(CARDS_TO_ONE) * 0.9
  for (let axis = 0; axis < 3; axis++) {
    const own = [0, 1, 2, 3].map(corner => position.getComponent(first + corner, axis))
    const middle = own.reduce((sum, one) => sum + one, 0) / CORNERS
    own.forEach((one, corner) => {
      corners[(first + corner) * 3 + axis] = middle + (one - middle) * factor
    })
  }
}

/** Return the wood's larger triangles alone: twigs are not seen from afar. */
export function thickWood(wood: BufferGeometry): BufferGeometry {
  const { index } = wood
  if (!index) return wood
  const areas = Float32Array.from({ length: index.count / 3 }, (_, at) => areaOf(wood, at * 3))
  const least = [...areas].sort((one, other) => other - one)[Math.floor(areas.length * BARK_SHARE)] ?? 0
  const kept = [...areas.keys()].filter(at => areas[at]! >= least)
  return withIndex(
    wood,
    kept.flatMap(at => [0, 1, 2].map(corner => index.getX(at * 3 + corner))),
  )
}

function areaOf(geometry: BufferGeometry, at: number): number {
  const position = geometry.getAttribute('position')
  const [a, b, c] = [0, 1, 2].map(corner => {
    const vertex = geometry.index!.getX(at + corner)
    return [position.getX(vertex), position.getY(vertex), position.getZ(vertex)] as const
  })
  const [u, v] = [b!, c!].map(end => end.map((one, axis) => one - a![axis]!))
  const cross = [
    u![1]! * v![2]! - u![2]! * v![1]!,
    u![2]! * v![0]! - u![0]! * v![2]!,
    u![0]! * v![1]! - u![1]! * v![0]!,
  ]
  return Math.hypot(...cross) / 2
}

function withIndex(geometry: BufferGeometry, index: readonly number[]): BufferGeometry {
  const part = new BufferGeometry()
  for (const [name, values] of Object.entries(geometry.attributes)) part.setAttribute(name, values)
  return part.setIndex(new BufferAttribute(Uint32Array.from(index), 1))
}
