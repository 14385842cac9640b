import type { components } from './schema'

/** Codes of problems that pass by themselves, so that the request can be sent again. */
const BUSY = ['overloaded', 'database_busy', 'database_unavailable', 'too_many_files']

/**
 * A problem that the service answered: the message says what is wrong, `pointer` where, such as /branches/0, and `retryAfter`
 * in how many seconds the request can be sent again.
 */
export class Refused extends Error {
  constructor(
    readonly status: number,
    readonly code: string,
    detail: string,
    readonly pointer: string | null,
    readonly retryAfter: number | null = null,
  ) {
    super(detail)
  }
}

/** The service cannot be reached, or cannot answer at present. */
export class Unreachable extends Error {}

/** Resolves to whether a request that was refused is to be sent again, once what it lacked is there. */
export type Gate = (refused: Refused) => Promise<boolean>

const CLOSED: Gate = async () => false
/** Who is signed in is the browser's cookie, so there is one gate for all requests of the page. */
let pageGate = CLOSED

/** Have every refused request of the page ask `gate` whether it is sent again. */
export function setGate(gate: Gate): void {
  pageGate = gate
}

/** Return what a request is answered; null where the answer is empty. Throws `Refused` or `Unreachable`. */
export async function request<T>(method: string, url: string, init: RequestInit = {}): Promise<T> {
  return read(await send(method, url, init))
}

/** Like `request`, but what is refused is thrown at once. */
export async function requestOnce<T>(method: string, url: string, init: RequestInit = {}): Promise<T> {
  return read(await send(method, url, init, CLOSED))
}

/** Return a successful response, or throw `Refused` or `Unreachable`. */
export async function send(method: string, url: string, init: RequestInit = {}, gate = pageGate): Promise<Response> {
  for (;;) {
    const response = await fetch(url, { ...init, method }).catch(() => {
      throw new Unreachable()
    })
    if (response.ok) return response
    const refused = await refusalOf(response)
    if (!(await gate(refused))) throw refused
  }
}

/** Return what sends a value as JSON. */
export function json(body: unknown, headers: Record<string, string> = {}): RequestInit {
  return { body: JSON.stringify(body), headers: { 'Content-Type': 'application/json', ...headers } }
}

async function read<T>(response: Response): Promise<T> {
  return (response.status === 204 ? null : await response.json()) as T
}

/** Return the problem that a response tells; throws `Unreachable` where it tells none, or one that passes. */
async function refusalOf(response: Response): Promise<Refused> {
  const problem: Partial<components['schemas']['Problem']> | null = await response.json().catch(() => null)
  if (!problem?.code || !problem.detail || BUSY.includes(problem.code)) throw new Unreachable()
  const pointer = problem.errors?.[0]?.pointer ?? null
  const retryAfter = Number(response.headers.get('Retry-After')) || null
  return new Refused(response.status, problem.code, problem.detail, pointer, retryAfter)
}
