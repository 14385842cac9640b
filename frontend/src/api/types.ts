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

export type Session = Schemas['SessionInfo']
export type Member = Schemas['MemberInfo']
export type Role = Member['role']
export type Team = Schemas['TeamInfo']
export type Key = Schemas['KeyInfo']
/** A key that was just made, which is told whole this once. */
export type MadeKey = Schemas['NewKey']
export type KeyOrder = Schemas['KeyRequest']
export type AuditEntry = Schemas['AuditEntry']
export type Quota = Schemas['QuotaNow']

export type Webhook = Schemas['WebhookInfo']
/** A webhook that was just made or changed, with its secret where that is new. */
export type MadeWebhook = Schemas['WebhookSecret']
export type WebhookOrder = Schemas['WebhookRequest']
export type WebhookChange = Partial<Schemas['WebhookChange']>
export type WebhookEvent = WebhookOrder['events'][number]
/** A message to a webhook, and what became of it. */
export type Delivery = Schemas['DeliveryInfo']
