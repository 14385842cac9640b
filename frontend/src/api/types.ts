import type { components } from './schema'

type Schemas = components['schemas']
export type TraceAnswer = Schemas['TraceAnswer']
export type SketchTraceAnswer = Schemas['SketchTraceAnswer']
export type Taken = Schemas['Taken']
export type TracedSkeleton = Schemas['TracedSkeleton']
export type StrokeWarning = Schemas['StrokeWarning']
export type StrokeSketch = Schemas['StrokeSketch']
export type WireStrokes = Schemas['Strokes']
export type Grown = Schemas['GrownSkeleton']
export type PhotoFrame = Schemas['PhotoFrame']
export type Model = Schemas['ModelInfo']
export type Limits = Schemas['Limits']
export type Settings = Required<Schemas['ModelSettings']>
export type WireCaptureStrokes = Schemas['CaptureStrokes']
export type CaptureInfo = Schemas['CaptureInfo']
export type CaptureState = Schemas['CaptureState']
export type CapturePhoto = Schemas['CapturePhotoInfo']
export type CameraInfo = Schemas['CameraInfo']
export type Cloud = Schemas['CloudInfo']

type Triple = [number, number, number]

/** What the service found in many photos; lengths and places are in the capture's frame. */
export interface CaptureTraceAnswer {
  rev: number | null
  /** Where the tree is in each photo that is used: closed rings, even-odd, px of the upright photo. */
  photos: { photo: string; foliage: [number, number][][] }[]
  /** The visible branches after the edits; `seen` is false where a joint only joins clusters or was added. */
  skeleton: {
    points: Triple[]
    radii: number[]
    parents: number[]
    seen: boolean[]
  }
  /** The surface of the measured crown; `guessed` where no photo shows it. */
  crown: {
    points: Triple[]
    triangles: Triple[]
    guessed: boolean[]
  }
  /** 3 x 4 by rows: a point of the capture's frame to the tree's frame, metres. */
  tree_from_capture: [number, number, number, number][]
  taken: Taken | null
  warnings: StrokeWarning[]
  grown?: Grown | null
  photo?: PhotoFrame | null
}
