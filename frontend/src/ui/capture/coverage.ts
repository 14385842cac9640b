import type { CameraInfo } from '../../api/types'
import { standpoint } from '../../preview/capture/photoCamera'
import { azimuthOf } from '../../preview/capture/placement'
import type { Similarity } from '../../preview/capture/similarity'

/** A gap between neighbouring photos that is wider leaves a side of the tree unseen, radians. */
export const WIDEST = Math.PI / 6
/** How many gaps a sentence names. */
const MOST_NAMED = 3

/** A photo on a plan of the tree: its direction from the front (radians, to the right) and how far away it was taken. */
export interface PlanPhoto {
  readonly photo: string
  readonly azimuth: number
  /** 1 in the median of the photos. */
  readonly distance: number
}

/** A range of directions that no photo was taken from, radians from the front to the right; `to` is beyond `from`. */
export interface Gap {
  readonly from: number
  readonly to: number
}

/** A direction in eighths of a turn from the front, to the right. */
export type Direction = 0 | 1 | 2 | 3 | 4 | 5 | 6 | 7

/** Return where photos were taken from, in the order of the cameras; the frame has the tree's middle at x = z = 0, its front at +Z. */
export function planOf(cameras: readonly CameraInfo[], tree: Similarity): PlanPhoto[] {
  const places = cameras.map(camera => standpoint(camera, tree).centre)
  const away = places.map(([x, , z]) => Math.hypot(x, z))
  const median = away.toSorted((one, other) => one - other)[Math.floor(away.length / 2)] || 1
  return cameras.map(({ photo }, at) => ({
    photo,
    azimuth: azimuthOf(places[at]!),
    distance: away[at]! / median,
  }))
}

/** Return the gaps between neighbouring photos that are too wide, the widest first. */
export function gapsIn(plan: readonly PlanPhoto[]): Gap[] {
  const turns = plan.map(({ azimuth }) => azimuth).toSorted((one, other) => one - other)
  const gaps = turns.map((from, at) => ({ from, to: turns[at + 1] ?? turns[0]! + 2 * Math.PI }))
  return gaps.filter(gap => widthOf(gap) > WIDEST).toSorted((one, other) => widthOf(other) - widthOf(one))
}

/** Return the directions from which more photos would help most, at most three, each once. */
export function missingDirections(gaps: readonly Gap[]): Direction[] {
  const middles = gaps.map(({ from, to }) => directionOf((from + to) / 2))
  return [...new Set(middles)].slice(0, MOST_NAMED)
}

/** Return the nearest eighth of a turn. */
export function directionOf(azimuth: number): Direction {
  const eighths = Math.round(azimuth / (Math.PI / 4))
  return (((eighths % 8) + 8) % 8) as Direction
}

function widthOf({ from, to }: Gap): number {
  return to - from
}
