import { type Client, Unreachable } from '../api/client'
import { follow, isOver } from '../api/follow'
import type { Model } from '../api/types'
import type { OwnPictures, Store } from '../state'
import type { Strokes } from '../strokes'
import { text } from '../text'
import { faultOf } from './faultText'
import { inputsOf } from './inputs'
import { treeOf } from './variants'

const AGAIN_MS = 2000
const TRIES = 5

/** Has trees grown and follows them until they stand in the preview. */
export class Grower {
  #leave = () => {}
  /** GLBs of the model that is shown, by their addresses. */
  readonly #trees = new Map<string, ArrayBuffer>()

  constructor(
    private readonly store: Store,
    private readonly client: Client,
  ) {}

  /** Ask for a tree of what is drawn. */
  async grow(): Promise<void> {
    const { settings, seed, name, leaf, fruit, faults } = this.store.state
    const strokes = this.store.strokes
    const inputs = inputsOf(this.store.state)
    if (!inputs || faults.strokes?.stroke || this.isGrowing) return
    this.store.fault('grow', null)
    this.store.set({ asking: true })
    try {
      const order = { inputs, settings, seed, name, leaf, fruit }
      this.show(await patiently(key => this.client.grow(order, key)), strokes, { leaf, fruit })
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
    return asking || (model !== null && !isOver(model.info))
  }

  /** Show a model, made of `strokes` and the person's own pictures, and follow it until it is finished. */
  show(info: Model, strokes: Strokes, { leaf, fruit }: OwnPictures): void {
    this.leave()
    this.#trees.clear()
    this.store.set({ model: { info, strokes, leaf, fruit, variant: 1, growth: null, glb: null }, shows: 'model' })
    this.#leave = follow(info.id, {
      changed: now => this.#change(now),
      grew: growth => {
        this.store.setModel(info.id, { growth })
        this.store.set({ shows: 'model' })
      },
      connected: online => this.store.set({ online }),
      gone: () => this.#forget(),
    })
  }

  /** Show another of the model's trees, from 1; the one before is shown until it has been fetched. */
  async choose(variant: number): Promise<void> {
    const { model } = this.store.state
    if (!model || !treeOf(model.info, variant)) return
    this.store.set({ model: { ...model, variant }, shows: 'model' })
    await this.#fetch(model.info)
  }

  /** Stop following the model. */
  leave(): void {
    this.#leave()
    this.#leave = () => {}
  }

  async cancel(): Promise<void> {
    const { model } = this.store.state
    if (!model) return
    try {
      this.#change(await patiently(() => this.client.cancelModel(model.info.id)))
    } catch (error) {
      this.store.fault('grow', faultOf(error))
    }
  }

  #change(model: Model): void {
    this.store.setModel(model.id, { info: model })
    this.store.set({ online: true })
    if (model.error) this.store.fault('grow', { text: model.error.detail })
    if (model.status === 'succeeded') this.#fetch(model)
  }

  /** Fetch the finished tree, or the one of them that was chosen. */
  async #fetch(info: Model): Promise<void> {
    const variant = this.store.state.model?.variant ?? 1
    try {
      const glb = await this.#download(treeOf(info, variant)!)
      const { model } = this.store.state
      if (model?.info.id !== info.id || model.variant !== variant) return
      this.store.set({ model: { ...model, glb }, shows: 'model' })
      this.store.fault('grow', null)
    } catch (error) {
      this.store.fault('grow', faultOf(error))
    }
  }

  async #download(url: string): Promise<ArrayBuffer> {
    const known = this.#trees.get(url)
    if (known) return known
    const tree = await (await patiently(() => this.client.getFile(url))).arrayBuffer()
    this.#trees.set(url, tree)
    return tree
  }

  #forget(): void {
    this.leave()
    this.store.set({ model: null, shows: 'live' })
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
