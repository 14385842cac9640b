import type { Client } from '../api/client'
import { isOver } from '../api/follow'
import { EMPTY, type Model, type State, type Store } from '../state'
import type { Grower } from './grower'
import { faultOf } from './sentences'

type Looked = Pick<State, 'model' | 'modelOf' | 'modelLeaf' | 'modelFruit' | 'variant' | 'growth' | 'tree' | 'shows'>

const NONE = lookedAt(EMPTY)

/** One's models, newest first, page by page. What goes wrong stands in the gallery's place of the state. */
export class Gallery {
  #next: string | null = null
  /** What was looked at when it was deleted. */
  #looked: Looked | null = null

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
      if (this.store.state.model?.id === id) this.store.set({ model, name })
      return model
    })
  }

  /** Delete a model; what is looked at goes with it, the drawing stays. */
  remove(id: string): Promise<true | null> {
    return this.#trying<true>(async () => {
      await this.client.removeModel(id)
      if (this.store.state.model?.id !== id) return true
      this.#looked = lookedAt(this.store.state)
      this.grower.leave()
      this.store.set(NONE)
      return true
    })
  }

  /** Take a deletion back. */
  restore(id: string): Promise<Model | null> {
    return this.#trying(async () => {
      const model = await this.client.restoreModel(id)
      if (this.#looked?.model?.id === id && !this.store.state.model) this.store.set({ ...this.#looked, model })
      return model
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

function lookedAt({ model, modelOf, modelLeaf, modelFruit, variant, growth, tree, shows }: State): Looked {
  return { model, modelOf, modelLeaf, modelFruit, variant, growth, tree, shows }
}
