import type { CameraInfo, CaptureTraceAnswer, TraceAnswer, TracedSkeleton } from './api/types'
import { seenBy } from './cameras'
import type { State } from './state'
import type { Point } from './strokes'

const seen = new WeakMap<CaptureTraceAnswer, Map<string, TraceAnswer>>()

/** Return whether an answer is about many photos. */
export function isOfPhotos(answer: TraceAnswer | CaptureTraceAnswer): answer is CaptureTraceAnswer {
  return 'tree_from_capture' in answer
}

/** Return what was traced in many photos; null where nothing was, or the tree has another source. */
export function tracedInSpace({ traced }: Pick<State, 'traced'>): CaptureTraceAnswer | null {
  return traced && isOfPhotos(traced.answer) ? traced.answer : null
}

/** Return what was traced as the open front shows it; of many photos, as the one that is drawn on shows it. Cached. */
export function tracedOn({ sheets, traced }: Pick<State, 'sheets' | 'traced'>): TraceAnswer | null {
  if (!traced) return null
  const { answer } = traced
  if (!isOfPhotos(answer)) return answer
  if (sheets?.source !== 'capture') return null
  const { name } = sheets.front
  const camera = sheets.capture.cameras.find(({ photo }) => photo === name)
  if (!camera) return null
  const byPhoto = seen.get(answer) ?? new Map<string, TraceAnswer>()
  seen.set(answer, byPhoto)
  const found = byPhoto.get(name) ?? inPhoto(answer, camera)
  byPhoto.set(name, found)
  return found
}

/** Return what a camera's photo shows of an answer; its joints keep their numbers. */
function inPhoto(answer: CaptureTraceAnswer, camera: CameraInfo): TraceAnswer {
  const { rev, photos, skeleton, taken, warnings } = answer
  const foliage = photos.find(({ photo }) => photo === camera.photo)?.foliage ?? []
  return { rev, foliage, skeleton: projected(skeleton, camera), taken, warnings }
}

function projected({ points, radii, parents }: CaptureTraceAnswer['skeleton'], camera: CameraInfo): TracedSkeleton {
  const at: Point[] = []
  const across: number[] = []
  for (const [joint, point] of points.entries()) {
    const { at: px, depth, scale } = seenBy(camera, point)
    // What is behind the camera is not in the photo: its joints collapse.
    at.push(depth > 0 ? px : (at[parents[joint]!] ?? [0, 0]))
    across.push(depth > 0 ? radii[joint]! * scale : 0)
  }
  return {
    points: at as [number, number][],
    radii: across,
    parents,
    stroke: parents.map(() => -1),
  }
}
