import { DEFAULT_SETTINGS } from './api/defaults'
import type { Grown, Limits, Model, Settings, TraceAnswer } from './api/types'
import { begin, type History } from './history'
import { type Line, NO_STROKES, type SheetName, type StrokeRef, type Strokes } from './strokes'

/** White paper, perhaps with a picture under the strokes. */
export interface Sheet {
  /** Of the photo that the service has; null where it has none. */
  readonly id: string | null
  /** Pixels, upright. */
  readonly width: number
  readonly height: number
  /** The picture as it was chosen: kept so that a drawing outlives the service's copy. */
  readonly file: Blob | null
  /** Where the upright picture can be shown from. */
  readonly url: string | null
  /** What was corrected while the picture was read, in words for the user. */
  readonly corrections?: string
  /** The picture is hidden for now. */
  readonly hidden?: true
}

/** A sheet with a photo that the service has. */
export interface PhotoSheet extends Sheet {
  readonly id: string
  readonly file: Blob
  readonly url: string
}

/** The sheets that are open, by what the tree is made of: strokes over a photo, or sketches of its sides. */
export type Sheets =
  | { readonly source: 'photo'; readonly front: PhotoSheet; readonly side: Sheet | null }
  | { readonly source: 'sketch'; readonly front: Sheet; readonly side: Sheet | null }

export type Source = Sheets['source']

/** What the pointer does on the photo. */
export type Tool = 'crown' | 'branch' | 'scale' | 'select'

/** A stroke, or a traced branch by the first of its joints. */
export type Selection = StrokeRef | { readonly kind: 'traced'; readonly joint: number }

/** Where an error stands on the page. */
export type Place = 'photo' | 'strokes' | 'grow' | 'preview' | 'gallery' | 'leaf' | 'fruit'

/** A sentence that says what is wrong and what to do. */
export interface Fault {
  readonly text: string
  /** The stroke at fault. */
  readonly stroke?: StrokeRef
}

/** A message that has no place of its own on the page; it goes by itself unless it `stays`. */
export interface Notice {
  readonly text: string
  /** What can be done about it. */
  readonly action?: { readonly label: string; run(): void }
  readonly stays?: true
  /** Called when it has gone. */
  gone?(): void
}

/** What was traced, and of which strokes. */
export interface Traced {
  readonly of: Strokes
  readonly answer: TraceAnswer
  /** The crowns that were taken on each sheet, where sketches were traced. */
  readonly crowns?: Readonly<Partial<Record<SheetName, Line>>>
}

/** A person's own pictures, PNGs. */
export interface OwnPictures {
  readonly leaf: Blob | null
  readonly fruit: Blob | null
}

/** A model that was asked for or opened, and what it was made of. */
export interface ShownModel extends OwnPictures {
  readonly info: Model
  /** What it was made of. */
  readonly strokes: Strokes
  /** Which of its trees is shown, from 1. */
  readonly variant: number
  /** Its skeleton, when it has just been grown. */
  readonly growth: Grown | null
  /** The GLB of the tree that is shown. */
  readonly glb: ArrayBuffer | null
}

export interface State extends OwnPictures {
  /** Null while nothing is open. */
  readonly sheets: Sheets | null
  /** The sheet that was touched last. */
  readonly active: SheetName
  readonly name: string
  readonly history: History<Strokes>
  readonly settings: Settings
  readonly seed: number
  readonly tool: Tool
  /** How wide branches are drawn on paper, as a share of its height; null for a pencil, which sets no width. */
  readonly brush: number | null
  readonly selection: Selection | null
  /** A photo, a sketch or a project is being read. */
  readonly opening: boolean
  readonly tracing: boolean
  readonly traced: Traced | null
  /** What was corrected while pictures of sketches were read, and the strokes that were read from them. */
  readonly corrections: { readonly of: Strokes; readonly text: string } | null
  /** The live tree. */
  readonly liveTree: Grown | null
  /** A model is being asked for. */
  readonly asking: boolean
  readonly model: ShownModel | null
  /** Whether the preview shows the live tree or the model. */
  readonly shows: 'live' | 'model'
  /** The dialog that is open. */
  readonly dialog: 'gallery' | 'shortcuts' | null
  /** What the service takes, once it has said so. */
  readonly limits: Limits | null
  /** False while the browser cannot keep the drawing. */
  readonly kept: boolean
  /** False while the service cannot be reached. */
  readonly online: boolean
  readonly faults: Readonly<Partial<Record<Place, Fault>>>
  readonly notices: readonly Notice[]
  /** What screen readers say. */
  readonly announcement: string
}

export const EMPTY: State = {
  sheets: null,
  active: 'front',
  name: '',
  history: begin(NO_STROKES),
  settings: DEFAULT_SETTINGS,
  seed: 0,
  leaf: null,
  fruit: null,
  tool: 'crown',
  brush: null,
  selection: null,
  opening: false,
  tracing: false,
  traced: null,
  corrections: null,
  liveTree: null,
  asking: false,
  model: null,
  shows: 'live',
  dialog: null,
  limits: null,
  kept: true,
  online: true,
  faults: {},
  notices: [],
  announcement: '',
}

/** Return the state with nothing open; what is not about the drawing stays. */
export function closed({ limits, online, notices, announcement }: State): State {
  return { ...EMPTY, limits, online, notices, announcement }
}

/** Holds the one state of the page and tells who listens what changed. */
export class Store {
  #state = EMPTY
  readonly #listeners = new Set<(now: State, before: State) => void>()

  get state(): State {
    return this.#state
  }

  get strokes(): Strokes {
    return this.#state.history.present
  }

  set(change: Partial<State>): void {
    const before = this.#state
    this.#state = { ...before, ...change }
    for (const listener of this.#listeners) listener(this.#state, before)
  }

  /** Change the model that is shown, where it still is the one with this id. */
  setModel(id: string, change: Partial<ShownModel>): void {
    const { model } = this.#state
    if (model?.info.id === id) this.set({ model: { ...model, ...change } })
  }

  /** Have screen readers say a sentence. */
  announce(announcement: string): void {
    // A region whose text stays the same is not read again.
    this.set({ announcement: announcement === this.#state.announcement ? `${announcement}\u00a0` : announcement })
  }

  /** Show a notice; the call ends it. */
  notify(notice: Notice): () => void {
    this.set({ notices: [...this.#state.notices, notice] })
    return () => this.dismiss(notice)
  }

  dismiss(notice: Notice): void {
    if (!this.#state.notices.includes(notice)) return
    this.set({ notices: this.#state.notices.filter(other => other !== notice) })
    notice.gone?.()
  }

  /** Put a fault in its place, or take it away. */
  fault(place: Place, fault: Fault | null): void {
    if (!fault && !this.#state.faults[place]) return
    const { [place]: _, ...others } = this.#state.faults
    this.set({ faults: fault ? { ...others, [place]: fault } : others })
  }

  /** Call `listener` with what `select` gives, now and whenever it gives something else; the call ends it. */
  watch<T>(select: (state: State) => T, listener: (value: T) => void): () => void {
    const told = (now: State, before: State) => {
      const value = select(now)
      if (value !== select(before)) listener(value)
    }
    this.#listeners.add(told)
    listener(select(this.#state))
    return () => this.#listeners.delete(told)
  }
}
