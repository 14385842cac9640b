import type { Client } from '../api/client'
import { Refused, Unreachable } from '../api/request'
import type { Grown } from '../api/types'
import { captureOf, hasPhoto, replaceSheet } from '../sheets'
import type { PhotoSheet, Sheets, Store, Traced } from '../state'
import type { Strokes } from '../strokes'
import { faultOf } from './faultText'
import { canTrace, isEnough, liveSettings, traced } from './inputs'
import { Rounds } from './rounds'

const RETRY_MS = 1500

/** What a live tree is grown of: strokes, and settings as JSON. */
interface Basis {
  readonly strokes: Strokes
  readonly settings: string
}

/**
 * Traces the strokes whenever they change, and grows the live tree, also when its settings change.
 *
 * There is one request at a time; then only the latest strokes are traced. The live tree is requested after tracing, if
 * the strokes have not changed again.
 */
export class Tracer {
  readonly #rounds = new Rounds(() => this.#catchUp())
  /** What the service refused: it is not sent again. */
  #refused: Basis | null = null
  /** What the service has answered the live tree of. */
  #grownOf: Basis | null = null

  constructor(
    private readonly store: Store,
    private readonly client: Client,
    private readonly wait = (ms: number) => new Promise<void>(done => setTimeout(done, ms)),
  ) {
    store.watch(
      state => state.history.present,
      () => this.#rounds.ask(),
    )
    store.watch(
      state => state.sheets?.front,
      () => this.#rounds.ask(),
    )
    store.watch(
      state => captureOf(state)?.cameras,
      () => this.#rounds.ask(),
    )
    store.watch(
      state => state.settings,
      () => this.#rounds.ask(),
    )
  }

  /** Send again what the service refused: it may have been too busy. */
  again(): void {
    this.#refused = null
    this.store.fault('strokes', null)
    void this.#rounds.ask()
  }

  async #catchUp(): Promise<void> {
    try {
      while (await this.#step()) {}
    } finally {
      this.store.set({ tracing: false })
    }
  }

  /** Send the next request that the strokes and settings need; returns whether there was one. */
  async #step(): Promise<boolean> {
    const { sheets, traced: found, liveTree } = this.store.state
    const basis = this.#basis()
    const { strokes } = basis
    const grows = isEnough(this.store.state)
    if (!grows && liveTree) this.store.set({ liveTree: null })
    if (!grows || !found) this.#grownOf = null
    if (!isSame(basis, this.#refused)) this.#refused = null
    const traceable = canTrace(this.store.state)
    if (!traceable && found) this.store.set({ traced: null, liveTree: null })
    if (!sheets || !traceable || this.#refused) return false
    const isTraced = found?.of === strokes
    if (isTraced && (!grows || isSame(basis, this.#grownOf))) return false
    try {
      await this.#request(sheets, basis, isTraced)
    } catch (error) {
      await this.#recover(error, sheets, basis)
    }
    return true
  }

  #basis(): Basis {
    return { strokes: this.store.strokes, settings: JSON.stringify(liveSettings(this.store.state)) }
  }

  /** Trace the strokes, or with `grow` request their live tree, and put the answer into the state. */
  async #request(sheets: Sheets, basis: Basis, grow: boolean): Promise<void> {
    if (!grow) this.store.set({ tracing: true })
    const found = await traced(this.client, this.store.state, grow)
    this.store.set({ online: true })
    if (this.#isStale(sheets, basis.strokes)) return
    this.store.fault('strokes', null)
    if (!grow) return this.#show({ of: basis.strokes, ...found })
    this.#showLive(basis, found.answer.grown ?? null)
  }

  /** Show the live tree, or the model that was made of the same strokes; other settings alone leave the choice. */
  #showLive(basis: Basis, liveTree: Grown | null): void {
    const { model, shows } = this.store.state
    const isOfModel = basis.strokes === model?.strokes
    const sameStrokes = basis.strokes === this.#grownOf?.strokes
    this.#grownOf = basis
    this.store.set({ liveTree, shows: sameStrokes ? shows : isOfModel ? 'model' : 'live' })
  }

  /** Show what was traced, and deselect a traced branch: its joint's number may now be another's. */
  #show(traced: Traced): void {
    const { selection } = this.store.state
    this.store.set({ traced, tracing: false, selection: selection?.kind === 'traced' ? null : selection })
  }

  /** Return whether the photo, the cameras or the strokes have changed since. */
  #isStale(sheets: Sheets, strokes: Strokes): boolean {
    const { sheets: now } = this.store.state
    const isOther =
      sheets.source === 'capture'
        ? captureOf({ sheets: now })?.cameras !== sheets.capture.cameras
        : now?.front.id !== sheets.front.id
    return isOther || this.store.strokes !== strokes
  }

  /** Wait where the service cannot be reached, send a lost photo again, or show a fault. */
  async #recover(error: unknown, sheets: Sheets, basis: Basis): Promise<void> {
    const isGone = error instanceof Refused && error.status === 404
    if (error instanceof Unreachable) {
      this.store.set({ online: false })
      await this.wait(RETRY_MS)
    } else if (isGone && hasPhoto(sheets.front)) {
      await this.#uploadAgain(sheets.front)
    } else if (isGone && sheets.source === 'capture') {
      if (!this.#isStale(sheets, basis.strokes)) this.store.set({ sheets: withoutCapture(sheets), solve: null })
    } else if (isGone && sheets.source === 'clip') {
      if (!this.#isStale(sheets, basis.strokes)) this.store.set({ sheets: withoutClip(sheets) })
    } else {
      this.#refused = basis
      if (!this.#isStale(sheets, basis.strokes)) this.store.fault('strokes', faultOf(error, basis.strokes.views))
    }
  }

  /** Send a photo again that the service no longer has. */
  async #uploadAgain(photo: PhotoSheet): Promise<void> {
    try {
      const { id } = await this.client.addPhoto(photo.file)
      const { sheets } = this.store.state
      if (sheets?.front.id === photo.id) this.store.set({ sheets: replaceSheet(sheets, 'front', { ...photo, id }) })
    } catch (error) {
      if (!(error instanceof Unreachable)) throw error
      await this.wait(RETRY_MS)
    }
  }
}

/** Return the sheets of many photos that the service no longer has. */
function withoutCapture(sheets: Sheets & { readonly source: 'capture' }): Sheets {
  return { ...sheets, capture: { ...sheets.capture, id: null } }
}

/** Return the sheets of a clip that the service no longer has. */
function withoutClip(sheets: Sheets & { readonly source: 'clip' }): Sheets {
  return { ...sheets, clip: { ...sheets.clip, id: null } }
}

function isSame(one: Basis, other: Basis | null): boolean {
  return one.strokes === other?.strokes && one.settings === other.settings
}
