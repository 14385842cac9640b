import type {
  CameraInfo,
  CaptureInfo,
  CapturePhoto,
  CaptureState,
  CaptureTraceAnswer,
  ClipInfo,
  ClipTraceAnswer,
  Grown,
  Model,
  SketchTraceAnswer,
  Taken,
  TraceAnswer,
} from '../src/api/types'
import { captureSheet, frameSheet } from '../src/sheets'
import type { Capture, Clip, PhotoSheet, Sheet, Sheets, ShownModel } from '../src/state'
import { type Line, NO_STROKES } from '../src/strokes'

/** The first bytes of a PNG: all that the page itself reads of one. */
export const PNG = new Uint8Array([137, 80, 78, 71, 13, 10, 26, 10])

export const CROWN: Line = [
  [20, 10],
  [80, 10],
  [80, 60],
  [20, 60],
]
export const TRUNK: Line = [
  [50, 95],
  [50, 40],
]
export const LIMB: Line = [
  [50, 50],
  [70, 30],
]

export function photo(changes: Partial<PhotoSheet> = {}): PhotoSheet {
  return { id: 'pho_1', width: 100, height: 100, file: new Blob(['a photo']), url: 'blob:photo', ...changes }
}

/** A photo that is open, alone or with the sheet of its left side. */
export function photoSheets(front = photo(), side: Sheet | null = null): Sheets {
  return { source: 'photo', front, side }
}

/** Paper that is open. */
export function sketchSheets(front: Sheet, side: Sheet | null = null): Sheets {
  return { source: 'sketch', front, side }
}

/** A photo of many as the service has it. */
export function capturePhoto(name: string, changes: Partial<CapturePhoto> = {}): CapturePhoto {
  const id = `cph_${name}`
  const size = { width: 100, height: 100, focal_px: null, image: `/v1/captures/cap_1/photos/${id}/image` }
  return { id, name, ...size, sha256: name, created: '', used: null, reason: null, ...changes }
}

/** Many photos that are open; the first is drawn on. */
export function captureSheets(names = ['00.jpg', '01.jpg'], changes: Partial<Capture> = {}): Sheets {
  const photos = names.map(name => capturePhoto(name))
  const capture = { id: 'cap_1', photos, cameras: [], cloud: null, chosen: photos.length, ...changes }
  return { source: 'capture', front: captureSheet(capture.photos[0]!), side: null, capture }
}

/** A clip of two seconds as the service has it. */
export function clipInfo(changes: Partial<ClipInfo> = {}): ClipInfo {
  const size = { width: 100, height: 100, frames: 60, frames_per_second: 30, seconds: 2 }
  return { id: 'clp_1', name: 'ash.mp4', ...size, notes: [], ...changes } as ClipInfo
}

/** A clip that is open, drawn over at a frame. */
export function clipSheets(changes: Partial<Clip> = {}, frame = 0): Sheets {
  const clip = { ...clipInfo(), ...changes }
  return { source: 'clip', front: frameSheet(clip, frame), side: null, clip }
}

/** An answer about a clip: one point is followed through three frames. */
export function clipAnswer(changes: Partial<ClipTraceAnswer> = {}): ClipTraceAnswer {
  const points: [number, number][] = [
    [50, 40],
    [52, 40],
    [54, 41],
  ]
  return { ...answer(), frame: 0, tracks: { frames_per_second: 30, every: 1, points: [points] }, ...changes }
}

/** A camera 10 units before the origin that looks along +Z, up being -Y. */
export function camera(photo: string): CameraInfo {
  return {
    photo,
    camera_from_world: [
      [1, 0, 0, 0],
      [0, 1, 0, 0],
      [0, 0, 1, 10],
    ],
    focal_px: 100,
    principal_px: [50, 50],
    size_px: [100, 100],
  }
}

/** An answer about many photos: a trunk of two joints. */
export function captureAnswer(changes: Partial<CaptureTraceAnswer> = {}): CaptureTraceAnswer {
  return {
    rev: null,
    photos: [],
    skeleton: {
      points: [
        [0, 2, 0],
        [0, -2, 0],
      ],
      radii: [1, 0.5],
      parents: [-1, 0],
      seen: [true, true],
    },
    crown: { points: [], triangles: [], guessed: [] },
    tree_from_capture: [
      [1, 0, 0, 0],
      [0, -1, 0, 2],
      [0, 0, -1, 0],
    ],
    taken: TAKEN,
    warnings: [],
    ...changes,
  }
}

/** A model that is shown. */
export function shownModel(info: Partial<Model> = {}, changes: Partial<ShownModel> = {}): ShownModel {
  const made = { strokes: NO_STROKES, leaf: null, fruit: null, variant: 1, sibling: 0, growth: null, glb: null }
  return { info: model(info), ...made, ...changes }
}

/** What a photo's tree was taken for. */
export const TAKEN: Taken = { foliage: 'needles', sureness: 0.83, form: 'spire', ask: false }

export function answer(grown: Grown | null = null): TraceAnswer {
  const skeleton = { points: [], radii: [], parents: [], stroke: [] }
  return { rev: null, foliage: [], skeleton, taken: null, warnings: [], grown, photo: null }
}

/** An answer about a traced sketch of the front. */
export function sketchAnswer(changes: Partial<SketchTraceAnswer> = {}): SketchTraceAnswer {
  const { skeleton } = answer()
  const front = {
    skeleton,
    crown: [[20, 10]] as [number, number][],
    crown_drawn: false,
    size: [900, 1200] as [number, number],
  }
  return { rev: null, front, side: null, warnings: [], ...changes }
}

/** An answer about a picture of a sketch: a trunk, and one limb that leaves it halfway. */
export function drawnAnswer(changes: Partial<SketchTraceAnswer['front']> = {}): SketchTraceAnswer {
  const skeleton = {
    points: [
      [50, 95],
      [50, 70],
      [50, 40],
      [60, 60],
      [70, 50],
    ] as [number, number][],
    radii: [6, 5, 1, 2, 2],
    parents: [-1, 0, 1, 1, 3],
    stroke: [0, 0, 0, 1, 1],
  }
  return sketchAnswer({ front: { skeleton, crown: [[20, 10]], crown_drawn: false, size: [100, 100], ...changes } })
}

export function grown(points = 2): Grown {
  return {
    points: Array.from({ length: points }, (_, i) => [0, i, 0] as [number, number, number]),
    radii: Array.from({ length: points }, () => 0.1),
    parents: Array.from({ length: points }, (_, i) => i - 1),
    born: Array.from({ length: points }, () => 0),
    photo: { width: 100, height: 100, metres_per_pixel: 0.1, root: [50, 95] },
  }
}

export function model(changes: Partial<Model> = {}): Model {
  return {
    ...{ id: 'mdl_1', name: 'Oak', photo: 'pho_1', status: 'queued', phase: null, phase_fraction: 0, progress: 0 },
    ...{ queue_position: 1, eta_s: null, attempt: 0, error: null, score: null, report: null, files: {} },
    ...{ settings: { height: 10 }, seed: 0, engine: 'treestroke', created: '', started: null, finished: null },
    ...changes,
  } as Model
}

/** How far the search for the cameras of many photos is. */
export function captureState(changes: Partial<CaptureState> = {}): CaptureState {
  return {
    ...{ id: 'cap_1', name: '', status: 'unsolved', phase: null, phase_fraction: 0, progress: 0, photo_count: 0 },
    ...{ queue_position: null, eta_s: null, attempt: 0, error: null, engine: null, created: '', started: null },
    ...{ finished: null, deleted: null, ...changes },
  } as CaptureState
}

/** A capture as the service has it. */
export function captureInfo(changes: Partial<CaptureInfo> = {}): CaptureInfo {
  return { ...captureState(), photos: [], cameras: [], cloud: null, ...changes }
}
