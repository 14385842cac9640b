import type { Client } from '../api/client'
import { DEFAULT_SETTINGS } from '../api/defaults'
import { Refused } from '../api/request'
import type { CaptureInfo, Model } from '../api/types'
import { begin, type History } from '../history'
import { captureSheet, drawnOn, fittedTo, paper, sheetOf, sheetOfSize } from '../sheets'
import { type Clip, closed, type PhotoSheet, type Sheet, type Sheets, type State, type Store } from '../state'
import { fromWire, NO_STROKES, onSheet, type SheetName, type Strokes, viewsFromWire, withSheet } from '../strokes'
import { text } from '../text'
import type { Captures } from './captures'
import type { Clips } from './clips'
import type { Draft, DraftStore, DraftWithPictures } from './draftStore'
import type { Example, PhotosExample, SketchExample } from './examples'
import { faultOf, PageFault, sentenceOf } from './faultText'
import type { Grower } from './grower'
import { pictureOf, upload } from './photos'
import { isProject, type Project, readProject } from './project'
import { replaceDrawing } from './sheetActions'
import { correctionsOn, type Drawn, pairSketches, type SketchFile } from './sketches'
import { readSketch } from './sketchPicture'

/** A drawing to open in place of the present one. */
interface Drawing extends Partial<Pick<State, 'settings' | 'seed' | 'leaf' | 'fruit'>> {
  readonly sheets: Sheets
  readonly name: string
  readonly history: History<Strokes>
  /** What was corrected while it was read, as sentences for the user. */
  readonly corrections?: string | undefined
}

/** The sheets of a draft, and how far the search for their cameras is, of many photos. */
interface Kept {
  readonly sheets: Sheets
  readonly solve?: CaptureInfo
}

/** Stands for a model's picture that was not kept: it differs from any other. */
const UNKNOWN_PICTURE = new Blob([])

/** Opens photos, paper, projects, examples, drafts and models; what is open stays until the next has been read. */
export class Opener {
  /** Counts requests to open something: only the last one is opened, however long the others take. */
  #requests = 0

  constructor(
    private readonly store: Store,
    private readonly client: Client,
    private readonly drafts: DraftStore,
    private readonly grower: Grower,
    private readonly captures: Captures,
    private readonly clips: Clips,
  ) {}

  /** Open a photo or a project that was chosen, dropped or pasted. */
  openFile(file: File): Promise<void> {
    return this.#opening(async () => {
      if (isProject(file)) return this.#openProject(await this.#readProject(file), stem(file.name))
      const sheets = onPhoto(await this.#upload(file))
      return () => this.#show({ sheets, name: stem(file.name), history: begin(NO_STROKES) })
    })
  }

  /** Open many photos of one tree; they are sent and their cameras are found while it is drawn. */
  openPhotos(files: readonly File[], name: string): Promise<void> {
    return this.#opening(() => this.#readPhotos(files, { name, history: begin(NO_STROKES) }))
  }

  /** Open an example of many photos. */
  openPhotosExample({ name, photos, strokes }: PhotosExample): Promise<void> {
    return this.#opening(async () => {
      const fetched = photos.map(async photo => new File([await this.client.getFile(photo.url)], photo.name))
      const history = begin(viewsFromWire(await jsonOf(await this.client.getFile(strokes))))
      return this.#readPhotos(await Promise.all(fetched), { name: text.examples[name] ?? name, history })
    })
  }

  /** Send a video of a tree and open it. */
  openClip(file: File): Promise<void> {
    return this.#opening(() => this.#readClip(file, { name: stem(file.name), history: begin(NO_STROKES) }))
  }

  /** Open two white sheets. */
  openPaper(): Promise<void> {
    return this.#opening(async () => () => {
      const sheets: Sheets = { source: 'sketch', front: paper(), side: paper() }
      this.#show({ sheets, name: '', history: begin(NO_STROKES) })
    })
  }

  /** Open a sketch of a tree's front, from JSON or a picture, to draw on. */
  openSketch(file: File): Promise<void> {
    return this.#opening(async () => {
      const drawn = await this.#onSheets({ photo: null, ...pairSketches(await this.#readSketch(file), null) })
      return () => this.#show({ ...drawn, name: stem(file.name) })
    })
  }

  /** Replace what is drawn on a sheet by a sketch; it can be undone. */
  openOn(sheet: SheetName, file: File): Promise<void> {
    return this.#opening(async () => {
      const sketch = await this.#readSketch(file)
      return () => {
        if (!sheetOf(this.store.state, sheet)) return
        this.store.set(replaceDrawing(this.store.state, sheet, sketch))
        this.#showCorrections(correctionsOn(sheet, sketch))
      }
    })
  }

  /** Open an example of sketches, and grow it. */
  openSketches({ name, front, side, leaf, fruit, settings }: SketchExample): Promise<void> {
    return this.#opening(async () => {
      const fetchFile = async (url: string | undefined) => (url ? await this.client.getFile(url) : null)
      const files = await Promise.all([front, side, leaf, fruit].map(fetchFile))
      const [frontSketch, sideSketch] = await Promise.all(
        files.slice(0, 2).map(async file => file && this.#readSketch(file)),
      )
      const drawn = await this.#onSheets({ photo: null, ...pairSketches(frontSketch!, sideSketch ?? null) })
      const own = { leaf: files[2] ?? null, fruit: files[3] ?? null }
      const chosen = { settings: { ...DEFAULT_SETTINGS, ...settings }, ...own }
      return () => this.#openAndGrow({ ...drawn, ...chosen, name: text.examples[name] ?? name })
    })
  }

  /** Open an example of a photo, and grow it. */
  openExample({ name, photo, strokes }: Example): Promise<void> {
    return this.#opening(async () => {
      const [file, drawn] = await Promise.all([this.client.getFile(photo), this.client.getFile(strokes)])
      const history = begin(fromWire(await jsonOf(drawn)))
      const sheets = onPhoto(await this.#upload(file))
      return () => this.#openAndGrow({ sheets, name: text.examples[name] ?? name, history })
    })
  }

  /** Open a draft, with the model that was last grown from it. */
  openDraft(id: string): Promise<void> {
    return this.#opening(async () => {
      const found = await this.drafts.find(id)
      if (!found) throw new PageFault(text.faults.draftGone)
      const { draft, leaf, fruit } = found
      const settings = { ...DEFAULT_SETTINGS, ...draft.settings }
      const { sheets, solve } = await this.#keptOf(found)
      const own = {
        leaf: draft.modelHadOtherLeaf ? UNKNOWN_PICTURE : leaf,
        fruit: draft.modelHadOtherFruit ? UNKNOWN_PICTURE : fruit,
      }
      return async () => {
        this.#show({ name: draft.name, history: draft.history, seed: draft.seed, sheets, settings, leaf, fruit }, id)
        if (solve) this.captures.goOn(solve)
        this.clips.keepThumbnail()
        const model = draft.model && (await this.#find(draft.model))
        if (model && draft.modelOf && this.drafts.id === id) this.grower.show(model, draft.modelOf, own)
      }
    })
  }

  /** Open a model with the drawing that it was made of. */
  openModel(id: string): Promise<void> {
    return this.#opening(async () => {
      const model = await this.#find(id)
      if (!model) throw new PageFault(text.faults.modelGone)
      if (model.capture) return this.#readCaptureModel(model, model.capture)
      if (model.clip) return this.#readClipModel(model, model.clip)
      const project = await this.#readProject(await this.client.getFile(model.files.project!))
      const settings = { ...DEFAULT_SETTINGS, ...model.settings }
      const { leaf, fruit = null } = project
      const drawn = await this.#onSheets(project, file => this.#photoOf(model.photo, file))
      return () => {
        this.#show({ ...drawn, name: model.name, settings, seed: model.seed, leaf, fruit })
        this.grower.show(model, drawn.history.present, { leaf, fruit })
      }
    })
  }

  /** Close the drawing, whose draft is kept, and show the start again. */
  close(): void {
    this.grower.stopFollowing()
    this.captures.stop()
    this.clips.stop()
    this.drafts.begin(null)
    this.store.set(closed(this.store.state))
  }

  /**
   * Read what should be opened, then call what `read` returns, which opens it; not if something else was requested, or
   * the drawing was left, meanwhile.
   */
  async #opening(read: () => Promise<() => void | Promise<void>>): Promise<void> {
    const [request, draft] = [++this.#requests, this.drafts.id]
    const isLast = () => request === this.#requests
    this.store.fault('photo', null)
    this.store.set({ opening: true })
    try {
      const open = await read()
      if (isLast() && this.drafts.id === draft) await open()
    } catch (error) {
      const fault = faultOf(error)
      if (isLast()) this.store.fault('photo', fault)
    } finally {
      if (isLast()) this.store.set({ opening: false })
    }
  }

  /** Send the first of many photos; return what opens them with a drawing, and sends the others. */
  async #readPhotos(files: readonly File[], drawing: Omit<Drawing, 'sheets'>): Promise<() => void> {
    const { sheets, rest } = await this.captures.begin(drawing.name, files)
    return () => {
      this.#show({ ...drawing, sheets })
      void this.captures.send(rest)
    }
  }

  /** Read a model of many photos; where the service no longer has these, they come from its project and are solved again. */
  async #readCaptureModel(model: Model, id: string): Promise<() => void> {
    const info = await this.#orNull(this.client.getCapture(id))
    const named = { name: model.name, settings: { ...DEFAULT_SETTINGS, ...model.settings }, seed: model.seed }
    const project = await this.#readProject(await this.client.getFile(model.files.project!))
    const { strokes, photos = [], leaf, fruit = null } = project
    const drawing = { ...named, history: begin(strokes), leaf, fruit }
    const sheets = info && this.captures.opened(info, strokes.views?.[0]?.photo ?? null)
    const open = sheets
      ? () => {
          this.#show({ ...drawing, sheets })
          this.captures.goOn(info)
        }
      : await this.#readPhotos(photos, drawing)
    return () => {
      open()
      this.grower.show(model, strokes, { leaf, fruit })
    }
  }

  /** Send a video; return what opens it with a drawing. */
  async #readClip(file: File, drawing: Omit<Drawing, 'sheets'>): Promise<() => void> {
    const info = await this.clips.send(file)
    return () => this.#showClip(info, drawing)
  }

  #showClip(clip: Clip, drawing: Omit<Drawing, 'sheets'>, draft: string | null = null): void {
    const notes = clip.notes?.map(({ detail }) => sentenceOf(detail)).join(' ')
    this.#show({ corrections: notes, ...drawing, sheets: this.clips.opened(clip, frameIn(drawing.history)) }, draft)
    this.clips.keepThumbnail()
  }

  /** Read a model of a clip; where the service no longer has it, it comes from the model's project and is sent again. */
  async #readClipModel(model: Model, id: string): Promise<() => void> {
    const info = await this.#orNull(this.client.getClip(id))
    const project = await this.#readProject(await this.client.getFile(model.files.project!))
    const { strokes, clip, leaf, fruit = null } = project
    const named = { name: model.name, settings: { ...DEFAULT_SETTINGS, ...model.settings }, seed: model.seed }
    const drawing = { ...named, history: begin(strokes), leaf, fruit }
    const open = info ? () => this.#showClip(info, drawing) : await this.#readClip(clip!, drawing)
    return () => {
      open()
      this.grower.show(model, strokes, { leaf, fruit })
    }
  }

  async #openProject(project: Project, name: string): Promise<() => void> {
    const { settings, seed, leaf, fruit = null, photos, clip, strokes } = project
    if (clip) return this.#readClip(clip, { name, history: begin(strokes), settings, seed, leaf, fruit })
    if (photos) return this.#readPhotos(photos, { name, history: begin(strokes), settings, seed, leaf, fruit })
    const drawn = await this.#onSheets(project)
    return () => this.#show({ ...drawn, name, settings, seed, leaf, fruit })
  }

  #readProject(file: Blob): Promise<Project> {
    return readProject(file, picture => this.#readSketch(picture))
  }

  #readSketch(file: Blob): Promise<SketchFile> {
    return readSketch(file, this.client, this.store.state.limits)
  }

  #upload(file: Blob): Promise<PhotoSheet> {
    return upload(file, this.client, this.store.state.limits)
  }

  /** Return a draft's sheets, by its source. */
  #keptOf(found: DraftWithPictures): Promise<Kept> {
    const { draft } = found
    if (draft.clip) return this.#clipOf(draft, draft.clip)
    return draft.capture ? this.#captureOf(draft, draft.capture) : this.#sheetsOf(found)
  }

  /** Return a draft's clip as the service has it; where it has lost it, as the draft does. */
  async #clipOf({ history }: Draft, clip: Clip): Promise<Kept> {
    const info = clip.id && (await this.#orNull(this.client.getClip(clip.id)))
    return { sheets: this.clips.opened(info || { ...clip, id: null }, frameIn(history)) }
  }

  /** Return a draft's sheets; if the service no longer has the photo, tracing will notice. */
  async #sheetsOf({ draft, photo: file, side: sidePicture }: DraftWithPictures): Promise<Kept> {
    const { photo, source } = draft
    const side = draft.side
      ? { ...sheetOfSize(draft.side), file: sidePicture, url: sidePicture && URL.createObjectURL(sidePicture) }
      : null
    if (!file) return { sheets: { source: 'sketch', front: sheetOfSize(photo), side } }
    if (source === 'sketch') return { sheets: { source, front: await this.#photoOf(photo.id, file), side } }
    const url = await pictureOf(file, photo, `/v1/photos/${photo.id}/image`)
    return { sheets: onPhoto({ ...photo, id: photo.id!, file, url }, side) }
  }

  /** Return a draft's many photos as the service has them; where it has lost them, as the draft does. */
  async #captureOf({ photo }: Draft, { id, photos, chosen }: NonNullable<Draft['capture']>): Promise<Kept> {
    const front = photos.find(other => other.id === photo.id) ?? photos[0]!
    const info = id && (await this.#orNull(this.client.getCapture(id)))
    const sheets = info && this.captures.opened(info, front.name, chosen)
    if (sheets) return { sheets, solve: info }
    const capture = { id: null, photos, chosen, cameras: [], cloud: null }
    return { sheets: { source: 'capture', front: captureSheet(front), side: null, capture } }
  }

  /** Return the sheet of a photo that the service has by this id; without one, or if it is gone, the file is sent. */
  async #photoOf(id: string | null, file: Blob): Promise<PhotoSheet> {
    if (id === null) return this.#upload(file)
    try {
      const { width, height, image } = await this.client.getPhoto(id)
      return { id, width, height, file, url: image }
    } catch (error) {
      if (!(error instanceof Refused)) throw error
      return this.#upload(file)
    }
  }

  /** Return a model; null where the service no longer has it. */
  #find(id: string): Promise<Model | null> {
    return this.#orNull(this.client.getModel(id))
  }

  /** Return what is asked for; null where the service refuses it. */
  async #orNull<T>(asked: Promise<T>): Promise<T | null> {
    try {
      return await asked
    } catch (error) {
      if (error instanceof Refused) return null
      throw error
    }
  }

  #openAndGrow(drawing: Drawing): void {
    this.#show(drawing)
    void this.grower.grow()
  }

  /** Show a drawing in place of the present one; its changes are saved as `draft`, or as a new one. */
  #show(drawing: Drawing, draft: string | null = null): void {
    const { sheets, name, history } = drawing
    const { settings = DEFAULT_SETTINGS, seed = 0, leaf = null, fruit = null } = drawing
    this.grower.stopFollowing()
    this.captures.stop()
    this.drafts.begin(draft)
    const tool = drawnOn({ sheets, history }, 'front').crown || sheets.source === 'sketch' ? 'branch' : 'crown'
    const opened = { sheets, name, history, settings, seed, leaf, fruit, tool } as const
    this.store.set({ ...closed(this.store.state), opening: true, ...opened })
    this.#showCorrections(drawing.corrections ?? sheets.front.corrections)
  }

  #showCorrections(text = ''): void {
    this.store.set({ corrections: text ? { of: this.store.strokes, text } : null })
  }

  /** Return a drawing on its sheets; the front's strokes are fitted to the photo under them. */
  async #onSheets(
    { photo: file, strokes, sizes = {}, corrections }: Drawn & Pick<Project, 'photo'>,
    upload = (photo: Blob) => this.#upload(photo),
  ) {
    const size = sizes.front
    const side = sizes.side ? sheetOfSize(sizes.side) : null
    if (!size) return { sheets: onPhoto(await upload(file!), side), history: begin(strokes), corrections }
    const front = file ? await upload(file) : sheetOfSize(size)
    const fitted = withSheet(strokes, 'front', fittedTo(onSheet(strokes, 'front'), size, front))
    const sheets: Sheets = { source: 'sketch', front, side: side ?? paper(front.height) }
    return { sheets, history: begin(fitted), corrections }
  }
}

function onPhoto(front: PhotoSheet, side: Sheet | null = null): Sheets {
  return { source: 'photo', front, side }
}

/** Return the frame of a clip that is drawn over. */
function frameIn({ present }: History<Strokes>): number {
  return present.frame ?? 0
}

async function jsonOf(file: Blob): Promise<unknown> {
  return JSON.parse(await file.text())
}

/** Return a file's name without its ending. */
function stem(name: string): string {
  return name.replace(/\.\w+$/, '')
}
