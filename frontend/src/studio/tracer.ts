import { type Client, Refused, Unreachable } from '../api/client'
import { isPhoto } from '../sheets'
import type { Ground, Photo, Store, Traced } from '../state'
import type { Strokes } from '../strokes'
import { canTrace, traced } from './evidence'
import { Rounds } from './rounds'
import { faultOf } from './sentences'

const AGAIN_MS = 1500

/**
 * Keeps what is traced and the live tree in step with the strokes.
 *
 * One request is under way at a time: what is drawn meanwhile is traced next, the latest only. Tracing comes first; the
 * live tree is asked for when nothing newer is waiting.
 */
export class Tracer {
  readonly #rounds = new Rounds(() => this.#catchUp())
  /** Strokes that the service refused: not sent again until others have been drawn. */
  #refused: Strokes | null = null
  #grownOf: Strokes | null = null

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
      state => state.photo,
      () => this.#rounds.ask(),
    )
  }

  async #catchUp(): Promise<void> {
    try {
      while (await this.#step()) {}
    } finally {
      this.store.set({ tracing: false })
    }
  }

  /** Do the next thing that is due; false where nothing is. */
  async #step(): Promise<boolean> {
    const { photo, traced: found, grown } = this.store.state
    const strokes = this.store.strokes
    if (!strokes.branches.length && grown) this.store.set({ grown: null })
    if (!strokes.branches.length) this.#grownOf = null
    if (strokes !== this.#refused) this.#refused = null
    const traceable = canTrace(this.store.state)
    if (!traceable && found) this.store.set({ traced: null, grown: null })
    if (!photo || !traceable || strokes === this.#refused) return false
    const isTraced = found?.of === strokes
    if (isTraced && (!strokes.branches.length || this.#grownOf === strokes)) return false
    try {
      await this.#ask(photo, strokes, isTraced)
    } catch (error) {
      await this.#mend(error, photo, strokes)
    }
    return true
  }

  async #ask(photo: Ground, strokes: Strokes, grow: boolean): Promise<void> {
    if (!grow) this.store.set({ tracing: true })
    const found = await traced(this.client, this.store.state, grow)
    this.store.set({ online: true })
    if (this.#isStale(photo, strokes)) return
    this.store.fault('strokes', null)
    if (!grow) return this.#take({ of: strokes, ...found })
    this.#grownOf = strokes
    this.store.set({
      grown: found.answer.grown ?? null,
      shows: strokes === this.store.state.modelOf ? 'model' : 'live',
    })
  }

  /** Show what was traced; a branch that was selected in the last answer may be another joint in this one. */
  #take(traced: Traced): void {
    const { selection } = this.store.state
    this.store.set({ traced, tracing: false, selection: selection?.kind === 'traced' ? null : selection })
  }

  #isStale(photo: Ground, strokes: Strokes): boolean {
    return this.store.state.photo?.id !== photo.id || this.store.strokes !== strokes
  }

  async #mend(error: unknown, photo: Ground, strokes: Strokes): Promise<void> {
    if (error instanceof Unreachable) {
      this.store.set({ online: false })
      await this.wait(AGAIN_MS)
    } else if (error instanceof Refused && error.status === 404 && isPhoto(photo)) {
      await this.#bringBack(photo)
    } else {
      this.#refused = strokes
      if (!this.#isStale(photo, strokes)) this.store.fault('strokes', faultOf(error))
    }
  }

  /** Send the photo again: the service has forgotten it. */
  async #bringBack(photo: Photo): Promise<void> {
    try {
      const { id } = await this.client.addPhoto(photo.file)
      if (this.store.state.photo?.id === photo.id) this.store.set({ photo: { ...photo, id } })
    } catch (error) {
      if (!(error instanceof Unreachable)) throw error
      await this.wait(AGAIN_MS)
    }
  }
}
