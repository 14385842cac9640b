import type { Client } from '../api/client'
import { isOver } from '../api/follow'
import type { Model } from '../api/types'
import type { State, Store } from '../state'
import { faultOf } from './faultText'
import type { Grower } from './grower'

/** The models of this service, newest first, page by page; what is wrong is put among the state's faults. */
export class Gallery {
  #next: string | null = null
  /** What was shown when it was deleted. */
  #deleted: Pick<State, 'model' | 'shows'> | null = null

  constructor(
    private readonly store: Store,
    private readonly client: Client,
    private readonly grower: Pick<Grower, 'leave'>,
  ) {}

  get hasMore(): boolean {
    return this.#next !== null
  }

  /** Give the next page; none where the service cannot be asked. */
  more(): Promise<Model[] | null> {
    return this.#trying(async () => {
      const { models, next } = await this.client.listModels(this.#next)
      this.#next = next
      return models
    })
  }

  rename(id: string, name: string): Promise<Model | null> {
    return this.#trying(async () => {
      const model = await this.client.renameModel(id, name)
      this.store.setModel(id, { info: model })
      if (this.store.state.model?.info.id === id) this.store.set({ name })
      return model
    })
  }

  /** Delete a model; where it is shown it goes, and the drawing stays. */
  remove(id: string): Promise<true | null> {
    return this.#trying<true>(async () => {
      await this.client.removeModel(id)
      const { model, shows } = this.store.state
      if (model?.info.id !== id) return true
      this.#deleted = { model, shows }
      this.grower.leave()
      this.store.set({ model: null, shows: 'live' })
      return true
    })
  }

  /** Take a deletion back. */
  restore(id: string): Promise<Model | null> {
    return this.#trying(async () => {
      const info = await this.client.restoreModel(id)
      const { model, shows } = this.#deleted ?? {}
      if (model?.info.id === id && !this.store.state.model) this.store.set({ model: { ...model, info }, shows: shows! })
      return info
    })
  }

  /** See how a model under way is now; null where that cannot be said. */
  async look(model: Model): Promise<Model | null> {
    return isOver(model) ? model : await this.client.getModel(model.id).catch(() => null)
  }

  async #trying<T>(ask: () => Promise<T>): Promise<T | null> {
    try {
      const answer = await ask()
      this.store.fault('gallery', null)
      return answer
    } catch (error) {
      this.store.fault('gallery', faultOf(error))
      return null
    }
  }
}
