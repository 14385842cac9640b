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
export type Limits = Schemas['Limits'] & { readonly quotas: readonly Quota[]; readonly rates: readonly Rate[] }
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
  readonly member: Pick<Member, 'id' | 'name' | 'role'>
  readonly team: Pick<Team, 'id' | 'name'>
  readonly scopes: readonly string[]
  readonly read_only: boolean
  readonly expires: number | null
}

export interface Member {
  readonly id: string
  readonly name: string
  readonly role: Role
  readonly created: number
}

export interface Team {
  readonly id: string
  readonly name: string
}

export interface Key {
  readonly id: string
  readonly name: string
  /** Its first characters, by which it is known again. */
  readonly beginning: string
  readonly member: Pick<Member, 'id' | 'name' | 'role'>
  readonly scopes: readonly string[]
  readonly read_only: boolean
  readonly created: number
  readonly expires: number
  readonly last_used: number | null
  readonly revoked: number | null
}

/** A key that was just made, which is told whole this once. */
export interface MadeKey extends Key {
  readonly key: string
}

/** How much a team may have of something, and how much it has. */
export interface Quota {
  readonly name: string
  /** Null where there is none. */
  readonly limit: number | null
  readonly used: number
}

/** How often something may be asked for. */
export interface Rate {
  readonly name: string
  readonly requests: number
  readonly seconds: number
  readonly remaining: number
}
