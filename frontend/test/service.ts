import { vi } from 'vitest'

/** A call as the service sees it. */
export interface Call {
  readonly method: string
  readonly path: string
  // biome-ignore lint/suspicious/noExplicitAny: a test looks into bodies of any form
  readonly body: any
}

type Answer = Response | 'down'

/** Stand in for the service behind `fetch`: `answer` says what it answers to each call; gives the calls that came. */
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

/** A problem as the service words it. */
export function problem(status: number, code: string, detail: string, pointer?: string): Response {
  const errors = pointer === undefined ? [] : [{ pointer, code, detail }]
  return Response.json({ type: 'about:blank', title: '', status, code, detail, errors }, { status })
}

/** Let everything that waits for promises go on. */
export async function settle(): Promise<void> {
  for (let i = 0; i < 30; i++) await Promise.resolve()
  await new Promise(done => setTimeout(done))
}

/** Stands in for the browser's event stream; a test says what it tells. */
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
