import { DEFAULT_SETTINGS } from './api/defaults'
import type {
  CameraInfo,
  CapturePhoto,
  CaptureState,
  CaptureTraceAnswer,
  ClipInfo,
  ClipTraceAnswer,
  Cloud,
  Grown,
  Limits,
  Model,
  Session,
  Settings,
  TraceAnswer,
} from './api/types'
import { begin, type History } from './history'
import { type Line, NO_STROKES, type SheetName, type StrokeRef, type Strokes } from './strokes'

/** A surface that is drawn on: a photo, or white paper with or without a picture under the strokes. */
export interface Sheet {
  /** The photo's id on the service; null where the service has none. */
  readonly id: string | null
  /** Size of the sheet, px; a picture is upright. */
  readonly width: number
  readonly height: number
  /** The picture as it was chosen; kept so that a drawing outlives the service's copy. */
  readonly file: Blob | null
  /** The address of the upright picture. */
  readonly url: string | null
  /** What was corrected while the picture was read, as sentences for the user. */
  readonly corrections?: string
  /** Set while the picture is hidden. */
  readonly hidden?: true
}

/** A sheet with a photo that the service has. */
export interface PhotoSheet extends Sheet {
  readonly id: string
  readonly file: Blob
  readonly url: string
}

/** The photo of many that is drawn on now. */
export interface CaptureSheet extends Sheet {
  readonly id: string
  /** Its name among the photos. */
  readonly name: string
}

/** Many photos of one tree. */
export interface Capture {
  /** Its id on the service; null where the service no longer has it. */
  readonly id: string | null
  /** The photos that the service has, by name. */
  readonly photos: readonly CapturePhoto[]
  /** The cameras of the photos that are used; empty until they are found. */
  readonly cameras: readonly CameraInfo[]
  /** Points that several photos show; null until the cameras are found. */
  readonly cloud: Cloud | null
  /** How many photos were chosen; some may not have reached the service. */
  readonly chosen: number
}

/** The frame of a clip that is drawn on now. */
export interface FrameSheet extends Sheet {
  /** Its number in the clip, from 0. */
  readonly frame: number
}

/** A video of one tree; its id is null where the service no longer has it. */
export type Clip = Omit<ClipInfo, 'id'> & { readonly id: string | null }

/** The open sheets, by the tree's source: a photo with strokes, sketches, many photos, or a clip. */
export type Sheets =
  | { readonly source: 'photo'; readonly front: PhotoSheet; readonly side: Sheet | null }
  | { readonly source: 'sketch'; readonly front: Sheet; readonly side: Sheet | null }
  | { readonly source: 'capture'; readonly front: CaptureSheet; readonly side: null; readonly capture: Capture }
  | { readonly source: 'clip'; readonly front: FrameSheet; readonly side: null; readonly clip: Clip }

export type Source = Sheets['source']

/** What the pointer does on a sheet. */
export type Tool = 'crown' | 'branch' | 'scale' | 'select'

/** What the pointer does to the branches of many photos where the tree is shown. */
export type BranchTool = 'move' | 'add' | 'join'

/** A stroke, or a traced branch by its first joint. */
export type Selection = StrokeRef | { readonly kind: 'traced'; readonly joint: number }

/** Where a fault is shown on the page. */
export type Place =
  | 'photo'
  | 'capture'
  | 'clip'
  | 'strokes'
  | 'grow'
  | 'preview'
  | 'gallery'
  | 'account'
  | 'leaf'
  | 'fruit'

/** A sentence that says what is wrong and what to do. */
export interface Fault {
  readonly text: string
  /** The stroke at fault. */
  readonly stroke?: StrokeRef
}

/** Photos that were chosen together. */
export interface Offer {
  readonly photos: readonly File[]
  /** The names of other files among them. */
  readonly others: readonly string[]
  /** The name of their folder; empty where they come from none. */
  readonly name: string
}

/** A message that has no place of its own on the page; it disappears after a while unless it `stays`. */
export interface Notice {
  readonly text: string
  /** A button in the notice. */
  readonly action?: { readonly label: string; run(): void }
  readonly stays?: true
  /** Called when it has disappeared. */
  gone?(): void
}

/** What was traced, and from which strokes. */
export interface Traced {
  readonly of: Strokes
  readonly answer: TraceAnswer | CaptureTraceAnswer | ClipTraceAnswer
  /** The crown on each sheet, drawn or assumed, where sketches were traced; sheet px. */
  readonly crowns?: Readonly<Partial<Record<SheetName, Line>>>
}

/** A person's own pictures of a leaf and a fruit, PNGs. */
export interface OwnPictures {
  readonly leaf: Blob | null
  readonly fruit: Blob | null
}

/** A model that was asked for or opened, and what it was made of. */
export interface ShownModel extends OwnPictures {
  readonly info: Model
  /** The strokes that it was made of. */
  readonly strokes: Strokes
  /** The number of its tree that is shown, from 1. */
  readonly variant: number
  /** The number of the sibling that is shown in the tree's place; 0 where none is. */
  readonly sibling: number
  /** Its grown skeleton, once the service has sent it. */
  readonly growth: Grown | null
  /** The GLB of the tree that is shown. */
  readonly glb: ArrayBuffer | null
}

/** The parts of the dialog about one's account. */
export type AccountTab = 'keys' | 'team' | 'webhooks' | 'audit' | 'limits'

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
  /** How branches are edited where the tree is shown; null while they are not. */
  readonly branchTool: BranchTool | null
  /** The brush's width on paper, as a share of the paper's height; null for a pencil, which sets no width. */
  readonly brush: number | null
  readonly selection: Selection | null
  /** Whether a photo, a sketch, a project or a model is being opened. */
  readonly opening: boolean
  readonly tracing: boolean
  /** How far the search for the cameras of many photos is; null where none was asked for. */
  readonly solve: CaptureState | null
  /** Whether photos of many are being sent. */
  readonly sending: boolean
  /** How much of a clip has been sent, 0 to 1; null while none is. */
  readonly sent: number | null
  readonly traced: Traced | null
  /** What was corrected while pictures were read, as sentences, and the strokes that these are about. */
  readonly corrections: { readonly of: Strokes; readonly text: string } | null
  /** The live tree. */
  readonly liveTree: Grown | null
  /** Whether a model is being requested. */
  readonly asking: boolean
  readonly model: ShownModel | null
  /** Whether the preview shows the live tree or the model. */
  readonly shows: 'live' | 'model'
  /** The dialog that is open. */
  readonly dialog: 'gallery' | 'shortcuts' | 'photos' | 'advice' | 'clip' | 'filming' | 'grove' | AccountTab | null
  /** Photos that were chosen together, while it is asked what becomes of them. */
  readonly offer: Offer | null
  /** A video that was chosen, while it is said what becomes of it, and while it is sent. */
  readonly clipOffer: File | null
  /** Who is signed in to a hosted service; null while nobody is, and where nobody needs to. */
  readonly session: Session | null
  /** Whether one has to sign in: for the first time, or again in the midst of something. */
  readonly signIn: 'first' | 'again' | null
  /** The service's limits, once it has told them. */
  readonly limits: Limits | null
  /** False while the browser cannot save the drawing. */
  readonly kept: boolean
  /** False while the service cannot be reached. */
  readonly online: boolean
  readonly faults: Readonly<Partial<Record<Place, Fault>>>
  readonly notices: readonly Notice[]
  /** The last sentence for screen readers. */
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
  branchTool: null,
  brush: null,
  selection: null,
  opening: false,
  tracing: false,
  solve: null,
  sending: false,
  sent: null,
  traced: null,
  corrections: null,
  liveTree: null,
  asking: false,
  model: null,
  shows: 'live',
  dialog: null,
  offer: null,
  clipOffer: null,
  session: null,
  signIn: null,
  limits: null,
  kept: true,
  online: true,
  faults: {},
  notices: [],
  announcement: '',
}

/** Return the state with nothing open; what does not belong to the drawing stays. */
export function closed({ session, signIn, limits, online, notices, announcement }: State): State {
  return { ...EMPTY, session, signIn, limits, online, notices, announcement }
}

/** Holds the page's one state, and calls listeners when it changes. */
export class Store {
  #state = EMPTY
  readonly #listeners = new Set<(now: State, before: State) => void>()

  get state(): State {
    return this.#state
  }

  /** The present strokes. */
  get strokes(): Strokes {
    return this.#state.history.present
  }

  /** Change parts of the state. */
  set(change: Partial<State>): void {
    const before = this.#state
    this.#state = { ...before, ...change }
    for (const listener of this.#listeners) listener(this.#state, before)
  }

  /** Change the shown model if it still is the one with this id. */
  setModel(id: string, change: Partial<ShownModel>): void {
    const { model } = this.#state
    if (model?.info.id === id) this.set({ model: { ...model, ...change } })
  }

  /** Have screen readers say a sentence. */
  announce(announcement: string): void {
    // A region whose text stays the same is not read again.
    this.set({ announcement: announcement === this.#state.announcement ? `${announcement}\u00a0` : announcement })
  }

  /** Show a notice; returns a function that dismisses it. */
  notify(notice: Notice): () => void {
    this.set({ notices: [...this.#state.notices, notice] })
    return () => this.dismiss(notice)
  }

  /** Remove a notice; does nothing where it has gone. */
  dismiss(notice: Notice): void {
    if (!this.#state.notices.includes(notice)) return
    this.set({ notices: this.#state.notices.filter(other => other !== notice) })
    notice.gone?.()
  }

  /** Set the fault of a place, or remove it (null). */
  fault(place: Place, fault: Fault | null): void {
    if (!fault && !this.#state.faults[place]) return
    const { [place]: _, ...others } = this.#state.faults
    this.set({ faults: fault ? { ...others, [place]: fault } : others })
  }

  /** Call `listener` with what `select` returns, now and whenever that changes; returns a function that ends this. */
  watch<T>(select: (state: State) => T, listener: (value: T) => void): () => void {
    const onChange = (now: State, before: State) => {
      const value = select(now)
      if (value !== select(before)) listener(value)
    }
    this.#listeners.add(onChange)
    listener(select(this.#state))
    return () => this.#listeners.delete(onChange)
  }
}
