import { type Client, Unreachable } from '../api/client'
import { follow, isOver } from '../api/follow'
import type { Model, State, Store } from '../state'
import type { Strokes } from '../strokes'
import { text } from '../text'
import { evidenceOf } from './evidence'
import { faultOf } from './sentences'
import { treeOf } from './variants'

const AGAIN_MS = 2000
const TRIES = 5

/** Has trees grown and follows them until they stand in the preview. */
export class Grower {
  #leave = () => {}
  /** Of the model that is looked at, by their addresses. */
  readonly #trees = new Map<string, ArrayBuffer>()

  constructor(
    private readonly store: Store,
    private readonly client: Client,
  ) {}

  /** Ask for a tree of what is drawn. */
  async grow(): Promise<void> {
    const { settings, seed, name, leaf, fruit, faults } = this.store.state
    const strokes = this.store.strokes
    const evidence = evidenceOf(this.store.state)
    if (!evidence || faults.strokes?.stroke || this.isGrowing) return
    this.store.fault('grow', null)
    this.store.set({ asking: true })
    try {
      const wish = { evidence, settings, seed, name, leaf, fruit }
      this.show(await patiently(key => this.client.grow(wish, key)), strokes, { leaf, fruit })
    } catch (error) {
      this.store.fault('grow', faultOf(error))
    } finally {
      this.store.set({ asking: false })
    }
  }

  /** Grow another tree of the same strokes. */
  async reroll(): Promise<void> {
    this.store.set({ seed: Math.floor(Math.random() * 1_000_000) })
    await this.grow()
  }

  get isGrowing(): boolean {
    const { asking, model } = this.store.state
    return asking || (model !== null && !isOver(model))
  }

  /** Follow a model, made of `strokes` and with pictures of one's own or none, into the preview. */
  show(model: Model, strokes: Strokes, { leaf, fruit }: Pick<State, 'leaf' | 'fruit'>): void {
    this.leave()
    this.#trees.clear()
    const looked = { modelOf: strokes, modelLeaf: leaf, modelFruit: fruit, variant: 1 }
    this.store.set({ model, ...looked, growth: null, tree: null, shows: 'model' })
    this.#leave = follow(model.id, {
      changed: now => this.#change(now),
      grew: growth => this.store.set({ growth, shows: 'model' }),
      connected: online => this.store.set({ online }),
      gone: () => this.#forget(),
    })
  }

  /** Look at another of the model's trees, from 1; the one before stays in sight until it has come. */
  async choose(variant: number): Promise<void> {
    const { model } = this.store.state
    if (!model || !treeOf(model, variant)) return
    this.store.set({ variant, shows: 'model' })
    await this.#fetch(model)
  }

  /** Follow no model any more. */
  leave(): void {
    this.#leave()
    this.#leave = () => {}
  }

  async cancel(): Promise<void> {
    const { model } = this.store.state
    if (!model) return
    try {
      this.#change(await patiently(() => this.client.cancelModel(model.id)))
    } catch (error) {
      this.store.fault('grow', faultOf(error))
    }
  }

  #change(model: Model): void {
    this.store.set({ model, online: true })
    if (model.error) this.store.fault('grow', { text: model.error.detail })
    if (model.status === 'succeeded') this.#fetch(model)
  }

  /** Bring the finished tree, or the one of them that was chosen. */
  async #fetch(model: Model): Promise<void> {
    const { variant } = this.store.state
    try {
      const tree = await this.#bring(treeOf(model, variant)!)
      const { state } = this.store
      if (state.model?.id !== model.id || state.variant !== variant) return
      this.store.set({ tree, shows: 'model' })
      this.store.fault('grow', null)
    } catch (error) {
      this.store.fault('grow', faultOf(error))
    }
  }

  async #bring(url: string): Promise<ArrayBuffer> {
    const known = this.#trees.get(url)
    if (known) return known
    const tree = await (await patiently(() => this.client.getFile(url))).arrayBuffer()
    this.#trees.set(url, tree)
    return tree
  }

  #forget(): void {
    this.leave()
    this.store.set({ model: null, modelOf: null, shows: 'live' })
    this.store.fault('grow', { text: text.faults.modelGone })
  }
}

/** Try again while the service cannot be reached, under one key, so that what arrived twice is done once. */
async function patiently<T>(ask: (key: string) => Promise<T>): Promise<T> {
  const key = crypto.randomUUID()
  for (let left = TRIES; ; left--) {
    try {
      return await ask(key)
    } catch (error) {
      if (!(error instanceof Unreachable) || left === 1) throw error
      await new Promise(done => setTimeout(done, AGAIN_MS))
    }
  }
}
