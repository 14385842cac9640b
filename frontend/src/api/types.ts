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
export type CameraInfo = Schemas['CameraInfo']
export type CloudInfo = Schemas['CloudInfo']
