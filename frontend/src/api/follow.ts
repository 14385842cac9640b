import type { CaptureState, Grown, Model } from './types'

/** Receives the events of a job of the service. */
export interface Following<Job> {
  changed(job: Job): void
  /** The connection was made, or was lost; then the browser connects again by itself. */
  connected(yes: boolean): void
  /** The job is gone, and so are its events. */
  gone(): void
}

/** Receives the events of a model. */
export interface ModelFollowing extends Following<Model> {
  /** Its skeleton is grown; leaves and mesh are not finished yet. */
  grew(grown: Grown): void
}

/** The statuses of finished models, and the names of the events that tell them. */
const FINISHED = ['succeeded', 'failed', 'canceled'] as const
/** The statuses of captures whose cameras nothing looks for, and the names of the events that tell them. */
const SETTLED = ['solved', 'failed', 'unsolved'] as const

/** Follow a model's events until it is finished; returns a function that stops this earlier. */
export function follow(id: string, listener: ModelFollowing): () => void {
  return stream(`/v1/models/${id}/events`, FINISHED, listener, on => on('preview', listener.grew))
}

/** Follow the search for a capture's cameras until it is settled; returns a function that stops this earlier. */
export function followCapture(id: string, listener: Following<CaptureState>): () => void {
  return stream(`/v1/captures/${id}/events`, SETTLED, listener)
}

/** Return whether a model is finished: it succeeded, failed or was canceled. */
export function isFinished(model: Model): boolean {
  return FINISHED.some(status => status === model.status)
}

/** Return whether a capture's cameras are being looked for. */
export function isSolving(solve: CaptureState | null): boolean {
  return solve?.status === 'queued' || solve?.status === 'running'
}

type Listen = <T>(name: string, receive: (value: T) => void) => void

function stream<Job>(
  url: string,
  lastNames: readonly string[],
  listener: Following<Job>,
  more: (on: Listen) => void = () => {},
): () => void {
  const events = new EventSource(url)
  const stop = () => events.close()
  const on: Listen = (name, receive) =>
    events.addEventListener(name, event => receive(JSON.parse((event as MessageEvent<string>).data)))
  events.onopen = () => listener.connected(true)
  // A browser closes the stream by itself only where the response is not one, as for a job that is gone.
  events.onerror = () => (events.readyState === EventSource.CLOSED ? listener.gone() : listener.connected(false))
  on('snapshot', listener.changed)
  on('progress', listener.changed)
  more(on)
  for (const name of lastNames) {
    on<Job>(name, job => {
      stop()
      listener.changed(job)
    })
  }
  return stop
}
