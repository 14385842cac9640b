import { frameToWire, type Point, type Strokes, toWire, viewsToWire } from '../strokes'
import { json, request, send } from './request'
import type { components } from './schema'
import type {
  CaptureInfo,
  CapturePhoto,
  CaptureTraceAnswer,
  ClipInfo,
  ClipTraceAnswer,
  Limits,
  Model,
  Settings,
  Share,
  SketchTraceAnswer,
  TraceAnswer,
  UploadInfo,
} from './types'

type Schemas = components['schemas']

type Sketches = Schemas['Sketches']

/** What a tree is made of: strokes over a photo, sketches, or both; or strokes over the photos of a capture, or over a frame of a clip. */
export interface Inputs {
  readonly photo?: string
  readonly capture?: string
  readonly clip?: string
  readonly strokes?: Strokes
  readonly sketches?: Sketches
}

/** What a request to trace a photo asks for beside what its strokes show. */
interface TraceRequest {
  /** Whether the live tree is grown too. */
  readonly grow: boolean
  /** What the live tree grows by. */
  readonly settings?: Partial<Settings>
  /** A sketch of the side, which sets the live tree's depth. */
  readonly side?: Sketches['side']
}

/** A request for siblings of a model's tree. */
export interface SiblingsOrder {
  readonly count: number
  readonly seed: number
  /** The outline that they fill: a shape by its name, or one that was drawn, px; absent for the tree's own. */
  readonly envelope?: string | { readonly points: readonly Point[] }
  /** Whether they are set in one scene, too. */
  readonly scene: boolean
}

/** What models are looked for: words in name, tags or the maker's name; a tag; the id of who made them. */
export interface Wanted {
  readonly q: string
  readonly tag: string
  readonly maker: string
}

/** A request for a model. */
export interface ModelRequest {
  readonly inputs: Inputs
  readonly settings: Settings
  readonly seed: number
  readonly name: string
  /** The own pictures of a leaf and a fruit. */
  readonly leaf: Blob | null
  readonly fruit: Blob | null
}

/** The page's calls to the service; each may throw `Refused` or `Unreachable`. */
export class Client {
  getLimits(): Promise<Limits> {
    return request('GET', '/v1/limits')
  }

  addPhoto(file: Blob): Promise<Schemas['PhotoInfo']> {
    const form = new FormData()
    form.append('file', file)
    return request('POST', '/v1/photos', { body: form })
  }

  getPhoto(id: string): Promise<Schemas['PhotoInfo']> {
    return request('GET', `/v1/photos/${id}`)
  }

  deletePhoto(id: string): Promise<void> {
    return request('DELETE', `/v1/photos/${id}`)
  }

  /** Trace foliage and visible branches, and grow the live tree where it is asked for. */
  trace(photo: string, strokes: Strokes, asked: TraceRequest): Promise<TraceAnswer> {
    return request('POST', `/v1/photos/${photo}/trace`, json({ ...toWire(strokes), ...asked }))
  }

  makeCapture(name: string): Promise<CaptureInfo> {
    return request('POST', '/v1/captures', json({ name }))
  }

  getCapture(id: string): Promise<CaptureInfo> {
    return request('GET', `/v1/captures/${id}`)
  }

  /** Add a photo to a capture; the same bytes by the same name are one photo, however often they are sent. */
  addCapturePhoto(id: string, file: Blob, name: string): Promise<CapturePhoto> {
    const form = new FormData()
    form.append('file', file, name)
    return request('POST', `/v1/captures/${id}/photos`, { body: form })
  }

  removeCapturePhoto(id: string, photo: string): Promise<void> {
    return request('DELETE', `/v1/captures/${id}/photos/${photo}`)
  }

  /** Have the cameras of a capture's photos found; at once where they were found before. */
  solveCapture(id: string): Promise<CaptureInfo> {
    return request('POST', `/v1/captures/${id}/solve`)
  }

  cancelSolve(id: string): Promise<CaptureInfo> {
    return request('POST', `/v1/captures/${id}/cancel`)
  }

  /** Find the tree in all photos of a solved capture, and grow the live tree where it is asked for. */
  traceCapture(id: string, strokes: Strokes, asked: Omit<TraceRequest, 'side'>): Promise<CaptureTraceAnswer> {
    return request('POST', `/v1/captures/${id}/trace`, json({ ...viewsToWire(strokes), ...editsIn(strokes), ...asked }))
  }

  /** Begin to send a clip in parts. */
  beginClip(name: string): Promise<UploadInfo> {
    return request('POST', `/v1/clips?name=${encodeURIComponent(name)}`, { headers: { 'Upload-Complete': '?0' } })
  }

  /** Return how much of a clip has arrived. */
  getUpload(id: string): Promise<UploadInfo> {
    return request('GET', `/v1/uploads/${id}`)
  }

  /** Send the part of a clip that begins at `offset` bytes; the last one gives the clip. */
  sendPart(id: string, part: Blob, offset: number, isLast: boolean): Promise<UploadInfo | ClipInfo> {
    const headers = { 'Upload-Offset': String(offset), 'Upload-Complete': isLast ? '?1' : '?0' }
    return request('PATCH', `/v1/uploads/${id}`, { body: part, headers })
  }

  getClip(id: string): Promise<ClipInfo> {
    return request('GET', `/v1/clips/${id}`)
  }

  /** Follow the points of a tree through a clip and trace its branches, and grow the live tree where it is asked for. */
  traceClip(id: string, strokes: Strokes, asked: Omit<TraceRequest, 'side'>): Promise<ClipTraceAnswer> {
    return request('POST', `/v1/clips/${id}/trace`, json({ ...frameToWire(strokes), ...asked }))
  }

  /** Trace sketches; with `grow` the live tree too. */
  traceSketches(sketches: Sketches, grow: boolean): Promise<SketchTraceAnswer> {
    return request('POST', '/v1/sketches/trace', json({ ...sketches, grow }))
  }

  /** Trace a sketch that is a PNG. */
  async traceDrawing(picture: Blob): Promise<SketchTraceAnswer> {
    return this.traceSketches({ front: { picture: await base64(picture) } }, false)
  }

  /** Request a model; requests with the same `key` lead to one model. */
  async grow({ inputs, leaf, fruit, ...rest }: ModelRequest, key: string): Promise<Model> {
    const wireInputs = { ...inputs, ...drawnIn(inputs) }
    const pictures = { ...(leaf && { leaf: await base64(leaf) }), ...(fruit && { fruit: await base64(fruit) }) }
    return request('POST', '/v1/models', json({ ...wireInputs, ...rest, ...pictures }, { 'Idempotency-Key': key }))
  }

  /** Request siblings of a model's tree; requests with the same `key` lead to one model. */
  growSiblings(id: string, order: SiblingsOrder & { readonly name: string }, key: string): Promise<Model> {
    return request('POST', `/v1/models/${id}/siblings`, json(order, { 'Idempotency-Key': key }))
  }

  getModel(id: string): Promise<Model> {
    return request('GET', `/v1/models/${id}`)
  }

  /** Return a page of models, of those that are looked for; a page of a search may be empty where more follow. */
  listModels(cursor: string | null, wanted: Partial<Wanted> = {}): Promise<Schemas['ModelPage']> {
    const given = Object.entries({ ...wanted, ...(cursor && { cursor }) }).filter(([, value]) => value)
    return request('GET', `/v1/models?${new URLSearchParams([['limit', '24'], ...given])}`)
  }

  renameModel(id: string, name: string): Promise<Model> {
    return request('PATCH', `/v1/models/${id}`, json({ name }))
  }

  async removeModel(id: string): Promise<void> {
    await request('DELETE', `/v1/models/${id}`)
  }

  restoreModel(id: string): Promise<Model> {
    return request('POST', `/v1/models/${id}/restore`)
  }

  tagModel(id: string, tags: readonly string[]): Promise<Model> {
    return request('PATCH', `/v1/models/${id}`, json({ tags }))
  }

  /** Make a link by which anybody sees a model; its address is told this once. */
  shareModel(id: string, terms: Schemas['ShareRequest']): Promise<Share> {
    return request('POST', `/v1/models/${id}/shares`, json(terms))
  }

  async listShares(id: string): Promise<readonly Share[]> {
    return (await request<Schemas['ShareList']>('GET', `/v1/models/${id}/shares`)).shares
  }

  async revokeShare(id: string): Promise<void> {
    await request('DELETE', `/v1/shares/${id}`)
  }

  cancelModel(id: string): Promise<Model> {
    return request('POST', `/v1/models/${id}/cancel`)
  }

  /** Fetch a file, such as a model's GLB or a photo's picture. */
  async getFile(url: string): Promise<Blob> {
    return (await send('GET', url)).blob()
  }
}

/** Return the strokes of a request for a model, in its form. */
function drawnIn({ strokes, capture, clip }: Inputs) {
  if (!strokes) return {}
  if (clip) return { strokes: frameToWire(strokes) }
  return capture
    ? { strokes: undefined, views: viewsToWire(strokes), ...editsIn(strokes) }
    : { strokes: toWire(strokes) }
}

function editsIn({ edits }: Strokes) {
  return edits?.length ? { edits } : {}
}

/** Return a file in base64; the browser's reader does not block the page, however large the file is. */
function base64(file: Blob): Promise<string> {
  return new Promise((resolve, reject) => {
    const reader = new FileReader()
    reader.onload = () => resolve(String(reader.result).split(',')[1] ?? '')
    reader.onerror = () => reject(reader.error)
    reader.readAsDataURL(file)
  })
}
