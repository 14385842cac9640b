import type { Tracks } from '../../api/types'

/** How many frames of its way a point's tail shows. */
const TAIL = 9
/** How many points are shown at most: more would hide the tree. */
const MOST = 260

type Point = readonly [number, number]

/** A point that is seen in a frame, and the way it came, its place now last; px of the frame. */
export interface TrackPath {
  /** The number of its track. */
  readonly track: number
  readonly way: readonly Point[]
}

/** Return points that are seen in a frame of the clip, from 0, each with a short tail without gaps; of very many, a part. */
export function pathsAt({ points, every }: Tracks, frame: number): TrackPath[] {
  const at = Math.floor(frame / Math.max(every, 1))
  const step = Math.ceil(points.length / MOST)
  return points.flatMap((places, track) => {
    if (track % step || !places[at]) return []
    const way: Point[] = []
    for (let past = at; past >= Math.max(at - TAIL, 0) && places[past]; past--) way.unshift(places[past]!)
    return [{ track, way }]
  })
}
