import type { Client, Wanted } from '../api/client'
import { isFinished } from '../api/follow'
import type { Model } from '../api/types'
import type { State, Store } from '../state'
import { faultOf } from './faultText'
import type { Grower } from './grower'

/** The most pages that are asked for in a row while none holds anything: a search looks through so many models a page. */
const MOST_EMPTY = 10

/** The models of the service, newest first, page by page, all or those of a search; faults go to the state. */
export class Gallery {
  /** The cursor of the next page. */
  #next: string | null = null
  #wanted: Partial<Wanted> = {}
  /** The model that was shown when it was deleted. */
  #deleted: Pick<State, 'model' | 'shows'> | null = null

  constructor(
    private readonly store: Store,
    private readonly client: Client,
    private readonly grower: Pick<Grower, 'stopFollowing'>,
  ) {}

  get hasMore(): boolean {
    return this.#next !== null
  }

  /** Look for models: the next page is the first of these. */
  search(wanted: Partial<Wanted>): void {
    this.#wanted = wanted
    this.#next = null
  }

  /** Return the next page; null after a fault. A page of a search that began before the last one counts as empty. */
  more(): Promise<Model[] | null> {
    const wanted = this.#wanted
    return this.#attempt(async () => {
      for (let page = 0; page < MOST_EMPTY; page++) {
        const { models, next } = await this.client.listModels(this.#next, wanted)
        if (wanted !== this.#wanted) return []
        this.#next = next
        if (models.length || !next) return models
      }
      return []
    })
  }

  /** Give a model new tags; null after a fault. */
  tag(id: string, tags: readonly string[]): Promise<Model | null> {
    return this.#attempt(async () => {
      const model = await this.client.tagModel(id, tags)
      this.store.setModel(id, { info: model })
      return model
    })
  }

  /** Rename a model, and the drawing if it is the model that is shown; null after a fault. */
  rename(id: string, name: string): Promise<Model | null> {
    return this.#attempt(async () => {
      const model = await this.client.renameModel(id, name)
      this.store.setModel(id, { info: model })
      if (this.store.state.model?.info.id === id) this.store.set({ name })
      return model
    })
  }

  /** Delete a model; if it is shown it disappears, but the drawing stays. Null after a fault. */
  remove(id: string): Promise<true | null> {
    return this.#attempt<true>(async () => {
      await this.client.removeModel(id)
      const { model, shows } = this.store.state
      if (model?.info.id !== id) return true
      this.#deleted = { model, shows }
      this.grower.stopFollowing()
      this.store.set({ model: null, shows: 'live' })
      return true
    })
  }

  /** Undo the deletion of a model; null after a fault. */
  restore(id: string): Promise<Model | null> {
    return this.#attempt(async () => {
      const info = await this.client.restoreModel(id)
      const { model, shows } = this.#deleted ?? {}
      if (model?.info.id === id && !this.store.state.model) this.store.set({ model: { ...model, info }, shows: shows! })
      return info
    })
  }

  /** Return the model's present state; null where the service does not answer. */
  async refresh(model: Model): Promise<Model | null> {
    return isFinished(model) ? model : await this.client.getModel(model.id).catch(() => null)
  }

  /** Return what a call returns, or put its error among the faults and return null. */
  async #attempt<T>(call: () => Promise<T>): Promise<T | null> {
    try {
      const answer = await call()
      this.store.fault('gallery', null)
      return answer
    } catch (error) {
      this.store.fault('gallery', faultOf(error))
      return null
    }
  }
}
