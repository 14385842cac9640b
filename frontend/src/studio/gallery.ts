import type { Client } from '../api/client'
import { isFinished } from '../api/follow'
import type { Model } from '../api/types'
import type { State, Store } from '../state'
import { faultOf } from './faultText'
import type { Grower } from './grower'

/** The models of the service, newest first, page by page; faults go to the state. */
export class Gallery {
  /** The cursor of the next page. */
  #next: string | null = null
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

  /** Return the next page; null after a fault. */
  more(): Promise<Model[] | null> {
    return this.#attempt(async () => {
      const { models, next } = await this.client.listModels(this.#next)
      this.#next = next
      return models
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
