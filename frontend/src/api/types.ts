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

export type CaptureTraceAnswer = Schemas['CaptureTraceAnswer']
export type WireFrameStrokes = Schemas['FrameStrokes']
export type ClipInfo = Schemas['ClipInfo']
export type ClipTraceAnswer = Schemas['ClipTraceAnswer']
export type Tracks = Schemas['Tracks']
export type UploadInfo = Schemas['UploadInfo']

export type Share = Schemas['ShareInfo']
export type Maker = Schemas['MakerInfo']
export type Role = 'owner' | 'member' | 'viewer'

/** Who is signed in to a hosted service; an embedded one has one person, who need not sign in. */
export interface Session {
  readonly hosted: boolean
  readonly member: { readonly id: string; readonly name: string; readonly role: Role }
  readonly team: { readonly id: string; readonly name: string }
  readonly scopes: readonly string[]
  readonly read_only: boolean
  readonly expires: number | null
}
