import { DEFAULT_SETTINGS } from './api/defaults'
import type { components } from './api/schema'
import { begin, type History } from './history'
import { type Line, NO_STROKES, type SheetName, type StrokeRef, type Strokes } from './strokes'

type Schemas = components['schemas']
export type TraceAnswer = Schemas['TraceAnswer']
export type SketchTraceAnswer = Schemas['SketchTraceAnswer']
export type TracedSkeleton = Schemas['TracedSkeleton']
export type StrokeWarning = Schemas['StrokeWarning']
export type Grown = Schemas['GrownSkeleton']
export type PhotoFrame = Schemas['PhotoFrame']
export type Model = Schemas['ModelInfo']
export type Limits = Schemas['Limits']
export type Settings = Required<Schemas['ModelSettings']>

/** What is drawn on: white paper, perhaps with a picture under the strokes. */
export interface Ground {
  /** Of the photo that the service has; null where it has none. */
  readonly id: string | null
  /** Pixels, upright. */
  readonly width: number
  readonly height: number
  /** The picture as it was chosen: kept so that a drawing outlives the service's copy. */
  readonly file: Blob | null
  /** Where the upright picture can be shown from. */
  readonly url: string | null
  /** What was mended in reading the picture, in words for the user. */
  readonly mended?: string
  /** The picture is out of sight for now. */
  readonly hidden?: true
}

/** A photo that the service has. */
export interface Photo extends Ground {
  readonly id: string
  readonly file: Blob
  readonly url: string
}

/** What the tree is made of: strokes over a photo, or sketches of its sides. */
export type Source = 'photo' | 'sketch'

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

/** What was traced, and of which strokes. */
export interface Traced {
  readonly of: Strokes
  readonly answer: TraceAnswer
  /** The crowns that were taken on each sheet, where sketches were traced. */
  readonly crowns?: Readonly<Partial<Record<SheetName, Line>>>
}

export interface State {
  readonly source: Source
  /** The photo, or the front's sheet; null while nothing is open. */
  readonly photo: Ground | null
  /** The sheet of the tree's left side, while it is open. */
  readonly side: Ground | null
  /** The sheet that was touched last. */
  readonly sheet: SheetName
  readonly name: string
  readonly history: History<Strokes>
  readonly settings: Settings
  readonly seed: number
  /** The person's own picture of a leaf, a PNG. */
  readonly leaf: Blob | null
  /** And of a fruit. */
  readonly fruit: Blob | null
  readonly tool: Tool
  /** How wide branches are drawn on paper, as a share of its height; null for a pencil, which says nothing of it. */
  readonly brush: number | null
  readonly selection: Selection | null
  /** A photo, a sketch or a project is being read. */
  readonly opening: boolean
  readonly tracing: boolean
  readonly traced: Traced | null
  /** What was mended in reading the pictures of sketches, and the strokes that came of them. */
  readonly remark: { readonly of: Strokes; readonly text: string } | null
  /** The live tree. */
  readonly grown: Grown | null
  /** A model is being asked for. */
  readonly asking: boolean
  /** The model that was asked for last or is looked at. */
  readonly model: Model | null
  /** The strokes that the model was made of. */
  readonly modelOf: Strokes | null
  /** The leaf and the fruit that the model was made with. */
  readonly modelLeaf: Blob | null
  readonly modelFruit: Blob | null
  /** Which of the model's trees is looked at, from 1. */
  readonly variant: number
  /** The model's skeleton, when it has just been grown. */
  readonly growth: Grown | null
  /** The GLB of that tree. */
  readonly tree: ArrayBuffer | null
  /** Whether the preview shows the live tree or the model. */
  readonly shows: 'live' | 'model'
  /** What the service takes, once it has said so. */
  readonly limits: Limits | null
  /** False while the browser cannot keep the drawing. */
  readonly kept: boolean
  /** False while the service cannot be reached. */
  readonly online: boolean
  readonly faults: Readonly<Partial<Record<Place, Fault>>>
}

export const EMPTY: State = {
  source: 'photo',
  photo: null,
  side: null,
  sheet: 'front',
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
  remark: null,
  grown: null,
  asking: false,
  model: null,
  modelOf: null,
  modelLeaf: null,
  modelFruit: null,
  variant: 1,
  growth: null,
  tree: null,
  shows: 'live',
  limits: null,
  kept: true,
  online: true,
  faults: {},
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
