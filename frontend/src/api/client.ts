import { type Strokes, toWire } from '../strokes'
import type { components } from './schema'
import type { Limits, Model, Settings, SketchTraceAnswer, TraceAnswer } from './types'

type Schemas = components['schemas']

/** Refusals that only ask to come again. */
const BUSY = ['overloaded', 'database_busy', 'database_unavailable', 'too_many_files']

/** The service refused: `detail` is a sentence for the user, `pointer` the field at fault, such as /branches/0. */
export class Refused extends Error {
  constructor(
    readonly status: number,
    readonly code: string,
    detail: string,
    readonly pointer: string | null,
  ) {
    super(detail)
  }
}

/** The service cannot be reached, or is not able to answer just now. */
export class Unreachable extends Error {}

type Sketches = Schemas['Sketches']

/** What a tree is made of: strokes over a photo, sketches of its sides, or both. */
export interface Inputs {
  readonly photo?: string
  readonly strokes?: Strokes
  readonly sketches?: Sketches
}

/** A request for a model. */
export interface ModelRequest {
  readonly inputs: Inputs
  readonly settings: Settings
  readonly seed: number
  readonly name: string
  /** The person's own picture of a leaf. */
  readonly leaf: Blob | null
  /** And of a fruit. */
  readonly fruit: Blob | null
}

/** The service's calls that the page makes; each throws `Refused` or `Unreachable`. */
export class Client {
  getLimits(): Promise<Limits> {
    return ask('GET', '/v1/limits')
  }

  addPhoto(file: Blob): Promise<Schemas['PhotoInfo']> {
    const form = new FormData()
    form.append('file', file)
    return ask('POST', '/v1/photos', { body: form })
  }

  getPhoto(id: string): Promise<Schemas['PhotoInfo']> {
    return ask('GET', `/v1/photos/${id}`)
  }

  deletePhoto(id: string): Promise<void> {
    return ask('DELETE', `/v1/photos/${id}`)
  }

  /** Find foliage and visible branches; with `grow` the whole tree's skeleton too, as deep as its left side. */
  trace(photo: string, strokes: Strokes, grow: boolean, side?: Sketches['side']): Promise<TraceAnswer> {
    return ask('POST', `/v1/photos/${photo}/trace`, json({ ...toWire(strokes), grow, ...(side && { side }) }))
  }

  /** Find what sketches show; with `grow` the whole tree's skeleton too. */
  traceSketches(sketches: Sketches, grow: boolean): Promise<SketchTraceAnswer> {
    return ask('POST', '/v1/sketches/trace', json({ ...sketches, grow }))
  }

  /** Find what a sketch shows that is a picture, a PNG. */
  async traceDrawing(picture: Blob): Promise<SketchTraceAnswer> {
    return this.traceSketches({ front: { picture: await base64(picture) } }, false)
  }

  /** Ask for a model; the same `key` asks for the same one, however often it is sent. */
  async grow({ inputs: { strokes, ...inputs }, leaf, fruit, ...order }: ModelRequest, key: string): Promise<Model> {
    const drawn = { ...inputs, ...(strokes && { strokes: toWire(strokes) }) }
    const pictures = { ...(leaf && { leaf: await base64(leaf) }), ...(fruit && { fruit: await base64(fruit) }) }
    return ask('POST', '/v1/models', json({ ...drawn, ...order, ...pictures }, { 'Idempotency-Key': key }))
  }

  getModel(id: string): Promise<Model> {
    return ask('GET', `/v1/models/${id}`)
  }

  listModels(cursor: string | null): Promise<Schemas['ModelPage']> {
    return ask('GET', `/v1/models?limit=24${cursor ? `&cursor=${cursor}` : ''}`)
  }

  renameModel(id: string, name: string): Promise<Model> {
    return ask('PATCH', `/v1/models/${id}`, json({ name }))
  }

  async removeModel(id: string): Promise<void> {
    await ask('DELETE', `/v1/models/${id}`)
  }

  restoreModel(id: string): Promise<Model> {
    return ask('POST', `/v1/models/${id}/restore`)
  }

  cancelModel(id: string): Promise<Model> {
    return ask('POST', `/v1/models/${id}/cancel`)
  }

  /** Read a file, such as a model's GLB or a photo's picture. */
  async getFile(url: string): Promise<Blob> {
    return (await answer('GET', url)).blob()
  }
}

async function ask<T>(method: string, url: string, request: RequestInit = {}): Promise<T> {
  const response = await answer(method, url, request)
  return (response.status === 204 ? null : await response.json()) as T
}

async function answer(method: string, url: string, request: RequestInit = {}): Promise<Response> {
  const response = await fetch(url, { ...request, method }).catch(() => {
    throw new Unreachable()
  })
  if (response.ok) return response
  const problem: Partial<Schemas['Problem']> | null = await response.json().catch(() => null)
  if (!problem?.code || !problem.detail || BUSY.includes(problem.code)) throw new Unreachable()
  throw new Refused(response.status, problem.code, problem.detail, problem.errors?.[0]?.pointer ?? null)
}

function json(body: unknown, headers: Record<string, string> = {}): RequestInit {
  return { body: JSON.stringify(body), headers: { 'Content-Type': 'application/json', ...headers } }
}

/** The browser reads by itself: the page goes on meanwhile, however large the file is. */
function base64(file: Blob): Promise<string> {
  return new Promise((done, failed) => {
    const reader = new FileReader()
    reader.onload = () => done(String(reader.result).split(',')[1] ?? '')
    reader.onerror = () => failed(reader.error)
    reader.readAsDataURL(file)
  })
}
