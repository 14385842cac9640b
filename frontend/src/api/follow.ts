import type { Grown, Model } from './types'

/** Receives the events of a model. */
export interface Following {
  changed(model: Model): void
  /** Its skeleton is grown; leaves and mesh are not finished yet. */
  grew(grown: Grown): void
  /** The connection was made, or was lost; then the browser connects again by itself. */
  connected(yes: boolean): void
  /** The model is gone, and so are its events. */
  gone(): void
}

/** The statuses of finished models, and the names of the events that tell them. */
const FINISHED = ['succeeded', 'failed', 'canceled'] as const

/** Follow a model's events until it is finished; returns a function that stops this earlier. */
export function follow(id: string, listener: Following): () => void {
  const events = new EventSource(`/v1/models/${id}/events`)
  const stop = () => events.close()
  const on = (name: string, receive: (value: never) => void) =>
    events.addEventListener(name, event => receive(JSON.parse((event as MessageEvent<string>).data) as never))
  events.onopen = () => listener.connected(true)
  // A browser closes the stream by itself only where the response is not one, as for a model that is gone.
  events.onerror = () => (events.readyState === EventSource.CLOSED ? listener.gone() : listener.connected(false))
  on('snapshot', listener.changed)
  on('progress', listener.changed)
  on('preview', listener.grew)
  for (const name of FINISHED) {
    on(name, model => {
      stop()
      listener.changed(model)
    })
  }
  return stop
}

/** Return whether a model is finished: it succeeded, failed or was canceled. */
export function isFinished(model: Model): boolean {
  return FINISHED.some(status => status === model.status)
}
