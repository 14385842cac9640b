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
export type Model = Schemas['ModelInfo'] & { readonly clip?: string | null }
export type Limits = Schemas['Limits']
export type Settings = Required<Schemas['ModelSettings']>
export type WireCaptureStrokes = Schemas['CaptureStrokes']
export type CaptureInfo = Schemas['CaptureInfo']
export type CaptureState = Schemas['CaptureState']
export type CapturePhoto = Schemas['CapturePhotoInfo']
export type CameraInfo = Schemas['CameraInfo']
export type Cloud = Schemas['CloudInfo']

export type CaptureTraceAnswer = Schemas['CaptureTraceAnswer']

export type WireFrameStrokes = WireStrokes & { frame: number }

/** A clip as the service has it. */
export interface ClipInfo {
  readonly id: string
  readonly name: string
  readonly width: number
  readonly height: number
  readonly frames: number
  readonly frames_per_second: number
  readonly seconds: number
  readonly notes?: readonly StrokeWarning[]
}

/** A clip that is being sent: how many bytes have arrived, and the id of the clip that was made of them. */
export interface UploadInfo {
  readonly id: string
  readonly offset: number
  readonly clip: string | null
}

/** Points of a tree that were followed through the frames of a clip, px of the frame; null where one is not seen. */
export interface Tracks {
  readonly frames_per_second: number
  readonly every: number
  readonly points: readonly (readonly (readonly [number, number] | null)[])[]
}

export type ClipTraceAnswer = TraceAnswer & { readonly frame: number; readonly tracks: Tracks }
