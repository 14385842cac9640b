import { vi } from 'vitest'

/** A request as the service sees it. */
export interface Call {
  readonly method: string
  readonly path: string
  // biome-ignore lint/suspicious/noExplicitAny: a test looks into bodies of any form
  readonly body: any
}

type Answer = Response | 'down'

/** Replace the service behind `fetch`: `answer` returns the response to each call. Returns the list of calls. */
export function service(answer: (call: Call) => Answer | Promise<Answer>): Call[] {
  const calls: Call[] = []
  vi.stubGlobal('FileReader', Reader)
  vi.stubGlobal('fetch', async (path: string, { method = 'GET', body }: RequestInit = {}) => {
    const call = { method, path, body: typeof body === 'string' ? JSON.parse(body) : body }
    calls.push(call)
    const answered = await answer(call)
    if (answered === 'down') throw new TypeError('failed to fetch')
    return answered
  })
  return calls
}

/** Stands in for the browser's reader of files. */
class Reader {
  result: string | null = null
  onload = () => {}

  async readAsDataURL(file: Blob): Promise<void> {
    this.result = `data:${file.type};base64,${Buffer.from(await file.arrayBuffer()).toString('base64')}`
    this.onload()
  }
}

/** Return a problem as the service answers it. */
export function problem(status: number, code: string, detail: string, pointer?: string): Response {
  const errors = pointer === undefined ? [] : [{ pointer, code, detail }]
  return Response.json({ type: 'about:blank', title: '', status, code, detail, errors }, { status })
}

/** Wait until all pending promises have been handled. */
export async function settle(): Promise<void> {
  for (let i = 0; i < 30; i++) await Promise.resolve()
  await new Promise(done => setTimeout(done))
}

/** Stands in for the browser's event stream; a test sends its events by `tell`. */
export class Events extends EventTarget {
  static readonly CLOSED = 2
  static all: Events[] = []
  readyState = 1
  onopen = () => {}
  onerror = () => {}

  constructor(readonly url: string) {
    super()
    Events.all.push(this)
  }

  /** The stream that was opened last. */
  static get last(): Events {
    return Events.all.at(-1)!
  }

  tell(name: string, value: unknown): void {
    this.dispatchEvent(new MessageEvent(name, { data: JSON.stringify(value) }))
  }

  close(): void {
    this.readyState = Events.CLOSED
  }
}
