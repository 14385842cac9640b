import { lookingOnly } from '../access'
import type { Client, SiblingsOrder } from '../api/client'
import { follow, isFinished } from '../api/follow'
import { Refused, Unreachable } from '../api/request'
import type { Model } from '../api/types'
import type { OwnPictures, Store } from '../state'
import type { Strokes } from '../strokes'
import { text } from '../text'
import { faultOf } from './faultText'
import { inputsOf } from './inputs'
import { treeOf } from './variants'

/** How often a call is made while the service cannot be reached, and the pause between, ms. */
const TRIES = 5
const RETRY_MS = 2000

/** Requests models, follows their growth, and fetches their finished trees. */
export class Grower {
  #stopFollowing = () => {}
  /** The model that is followed, by its id. */
  #followed: string | null = null
  /** GLBs of the shown model that were fetched, by their addresses. */
  readonly #trees = new Map<string, ArrayBuffer>()

  constructor(
    private readonly store: Store,
    private readonly client: Client,
  ) {}

  /** Request a model of what is drawn. */
  async grow(): Promise<void> {
    const { settings, seed, name, leaf, fruit, faults, session } = this.store.state
    const strokes = this.store.strokes
    const inputs = inputsOf(this.store.state)
    if (!inputs || faults.strokes?.stroke || this.isGrowing || lookingOnly(session)) return
    this.store.fault('grow', null)
    this.store.set({ asking: true })
    try {
      const order = { inputs, settings, seed, name, leaf, fruit }
      this.show(await retrying(key => this.client.grow(order, key)), strokes, { leaf, fruit })
    } catch (error) {
      this.store.fault('grow', faultOf(error, strokes.views))
    } finally {
      this.store.set({ asking: false })
    }
  }

  /** Request a model by the settings as they are now, in place of the one that is shown or under way. */
  async regrow(): Promise<void> {
    const { model } = this.store.state
    if (model && !isFinished(model.info)) await this.cancel()
    await this.grow()
  }

  /** Request another model of the same strokes, with a random seed. */
  async reroll(): Promise<void> {
    this.store.set({ seed: Math.floor(Math.random() * 1_000_000) })
    await this.grow()
  }

  /** Whether a model was requested and is not finished. */
  get isGrowing(): boolean {
    const { asking, model } = this.store.state
    return asking || (model !== null && !isFinished(model.info))
  }

  /** Show a model that was made of these strokes and own pictures, and follow it until it is finished. */
  show(info: Model, strokes: Strokes, { leaf, fruit }: OwnPictures): void {
    this.stopFollowing()
    this.#trees.clear()
    this.store.set({
      model: { info, strokes, leaf, fruit, variant: 1, sibling: 0, growth: null, glb: null },
      shows: 'model',
    })
    this.#follow(info.id)
  }

  /** Show another of the model's trees, by its number from 1, or a sibling; the present one stays until it is fetched. */
  async choose(variant: number, sibling = 0): Promise<void> {
    const { model } = this.store.state
    if (!model || !treeOf(model.info, variant, sibling)) return
    this.store.set({ model: { ...model, variant, sibling }, shows: 'model' })
    await this.#fetch(model.info)
  }

  /** Request siblings of the shown tree, which come with a model of the same inputs. */
  async growSiblings(order: SiblingsOrder): Promise<void> {
    const { model, name } = this.store.state
    if (!model || this.isGrowing) return
    this.store.fault('grow', null)
    this.store.set({ asking: true })
    try {
      const info = await retrying(key => this.client.growSiblings(model.info.id, { ...order, name }, key))
      this.show(info, model.strokes, model)
      const { settings } = this.store.state
      this.store.set({ settings: { ...settings, ...info.settings }, seed: info.seed })
    } catch (error) {
      this.store.fault('grow', faultOf(error))
    } finally {
      this.store.set({ asking: false })
    }
  }

  /** Return a file of the shown model, which is kept while the model is shown. */
  file(url: string): Promise<ArrayBuffer> {
    return this.#download(url)
  }

  /** Stop following the model. */
  stopFollowing(): void {
    this.#followed = null
    this.#stopFollowing()
    this.#stopFollowing = () => {}
  }

  /** Cancel the growth of the shown model. */
  async cancel(): Promise<void> {
    const { model } = this.store.state
    if (!model) return
    try {
      this.#update(await retrying(() => this.client.cancelModel(model.info.id)))
    } catch (error) {
      this.store.fault('grow', faultOf(error))
    }
  }

  #follow(id: string): void {
    this.#followed = id
    this.#stopFollowing = follow(id, {
      changed: now => this.#update(now),
      grew: growth => {
        this.store.setModel(id, { growth })
        this.store.set({ shows: 'model' })
      },
      connected: online => this.store.set({ online }),
      gone: () => void this.#look(id),
    })
  }

  /** Look how the model is whose events have ended, then follow it again: it may be gone, or too many may be followed at once. */
  async #look(id: string): Promise<void> {
    try {
      const info = await this.client.getModel(id)
      if (this.#followed !== id) return
      this.#update(info)
      if (isFinished(info)) return
    } catch (error) {
      if (this.#followed !== id) return
      if (error instanceof Refused && error.status === 404) return this.#forget()
      if (!(error instanceof Unreachable)) return this.store.fault('grow', faultOf(error))
      this.store.set({ online: false })
    }
    await pause()
    if (this.#followed === id) this.#follow(id)
  }

  #update(model: Model): void {
    this.store.setModel(model.id, { info: model })
    this.store.set({ online: true })
    if (model.error) this.store.fault('grow', { text: model.error.detail })
    if (model.status === 'succeeded') this.#fetch(model)
  }

  /** Fetch and show the chosen tree of the finished model. */
  async #fetch(info: Model): Promise<void> {
    const { variant = 1, sibling = 0 } = this.store.state.model ?? {}
    try {
      const glb = await this.#download(treeOf(info, variant, sibling)!)
      const { model } = this.store.state
      if (model?.info.id !== info.id || model.variant !== variant || model.sibling !== sibling) return
      this.store.set({ model: { ...model, glb }, shows: 'model' })
      this.store.fault('grow', null)
    } catch (error) {
      this.store.fault('grow', faultOf(error))
    }
  }

  async #download(url: string): Promise<ArrayBuffer> {
    const known = this.#trees.get(url)
    if (known) return known
    const tree = await (await retrying(() => this.client.getFile(url))).arrayBuffer()
    this.#trees.set(url, tree)
    return tree
  }

  #forget(): void {
    this.stopFollowing()
    this.store.set({ model: null, shows: 'live' })
    this.store.fault('grow', { text: text.faults.modelGone })
  }
}

/** Return what a call returns; it is repeated while the service cannot be reached, with one key so that it acts once. */
async function retrying<T>(call: (key: string) => Promise<T>): Promise<T> {
  const key = crypto.randomUUID()
  for (let triesLeft = TRIES; ; triesLeft--) {
    try {
      return await call(key)
    } catch (error) {
      if (!(error instanceof Unreachable) || triesLeft === 1) throw error
      await pause()
    }
  }
}

function pause(): Promise<void> {
  return new Promise(done => setTimeout(done, RETRY_MS))
}
