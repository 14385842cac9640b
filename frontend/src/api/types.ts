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
