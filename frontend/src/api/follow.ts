import type { Grown, Model } from './types'

/** What happens to a model that is followed. */
export interface Following {
  changed(model: Model): void
  /** Its skeleton is grown; leaves and mesh are still to come. */
  grew(grown: Grown): void
  /** Whether its events arrive; the browser connects again by itself. */
  connected(yes: boolean): void
  /** There are no events any more: the model is gone. */
  gone(): void
}

const ENDS = ['succeeded', 'failed', 'canceled'] as const

/** Follow a model by its events until it is finished; the call ends it sooner. */
export function follow(id: string, told: Following): () => void {
  const events = new EventSource(`/v1/models/${id}/events`)
  const end = () => events.close()
  const on = (name: string, tell: (value: never) => void) =>
    events.addEventListener(name, event => tell(JSON.parse((event as MessageEvent<string>).data) as never))
  events.onopen = () => told.connected(true)
  // A browser gives up by itself only where the answer is no event stream, which is the case for a model that is gone.
  events.onerror = () => (events.readyState === EventSource.CLOSED ? told.gone() : told.connected(false))
  on('snapshot', told.changed)
  on('progress', told.changed)
  on('preview', told.grew)
  for (const name of ENDS) {
    on(name, model => {
      end()
      told.changed(model)
    })
  }
  return end
}

/** Tell whether nothing more will happen to a model. */
export function isOver(model: Model): boolean {
  return ENDS.some(end => end === model.status)
}
