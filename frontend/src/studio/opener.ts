import { type Client, Refused } from '../api/client'
import { DEFAULT_SETTINGS } from '../api/defaults'
import type { Model } from '../api/types'
import { begin, type History } from '../history'
import { fittedTo, paper, sheetOf, sheetOfSize } from '../sheets'
import { closed, type PhotoSheet, type Sheet, type Sheets, type State, type Store } from '../state'
import { fromWire, NO_STROKES, onSheet, type SheetName, type Strokes, withSheet } from '../strokes'
import { text } from '../text'
import type { DraftStore, DraftWithPictures } from './draftStore'
import type { Example, SketchExample } from './examples'
import { faultOf, Unusable } from './faultText'
import type { Grower } from './grower'
import { pictureOf, uploaded } from './photos'
import { isProject, type Project, readProject } from './project'
import { redrawn } from './sheetActions'
import { correctionsOn, type Drawn, paired, type SketchFile } from './sketches'
import { readSketch } from './sketchPicture'

/** What takes the place of the present drawing. */
interface Drawing extends Partial<Pick<State, 'settings' | 'seed' | 'leaf' | 'fruit'>> {
  readonly sheets: Sheets
  readonly name: string
  readonly history: History<Strokes>
  /** What was corrected while it was read. */
  readonly corrections?: string | undefined
}

/** Stands for a picture that is no longer known: it differs from any other. */
const FORGOTTEN = new Blob([])

/** Opens photos, paper, projects, examples, drawings and models; what was open before stays until that has worked. */
export class Opener {
  /** Counts what was asked to be opened: the last wins, whatever takes longest. */
  #asked = 0

  constructor(
    private readonly store: Store,
    private readonly client: Client,
    private readonly drafts: DraftStore,
    private readonly grower: Grower,
  ) {}

  /** Open a photo or a project that was chosen, dropped or pasted. */
  openFile(file: File): Promise<void> {
    return this.#opening(async () => {
      if (isProject(file)) return this.#projectOf(await this.#read(file), stem(file.name))
      const sheets = onPhoto(await this.#upload(file))
      return () => this.#put({ sheets, name: stem(file.name), history: begin(NO_STROKES) })
    })
  }

  /** Open two white sheets. */
  openPaper(): Promise<void> {
    return this.#opening(async () => () => {
      const sheets: Sheets = { source: 'sketch', front: paper(), side: paper() }
      this.#put({ sheets, name: '', history: begin(NO_STROKES) })
    })
  }

  /** Open a sketch of a tree's front, as strokes or as a picture, to be drawn on. */
  openSketch(file: File): Promise<void> {
    return this.#opening(async () => {
      const drawn = await this.#laidOut({ photo: null, ...paired(await this.#sketchIn(file), null) })
      return () => this.#put({ ...drawn, name: stem(file.name) })
    })
  }

  /** Open a sketch on a sheet, in the place of what is drawn there; an undo brings that back. */
  openOn(sheet: SheetName, file: File): Promise<void> {
    return this.#opening(async () => {
      const sketch = await this.#sketchIn(file)
      return () => {
        if (!sheetOf(this.store.state, sheet)) return
        this.store.set(redrawn(this.store.state, sheet, sketch))
        this.#showCorrections(correctionsOn(sheet, sketch))
      }
    })
  }

  /** Open an example that was drawn on paper, and grow it. */
  openSketches({ name, front, side, leaf, fruit, settings }: SketchExample): Promise<void> {
    return this.#opening(async () => {
      const bring = async (url: string | undefined) => (url ? await this.client.getFile(url) : null)
      const [ahead, left, ...own] = await Promise.all([front, side, leaf, fruit].map(bring))
      const [one, other] = await Promise.all([ahead, left].map(async file => file && this.#sketchIn(file)))
      const drawn = await this.#laidOut({ photo: null, ...paired(one!, other ?? null) })
      const how = { settings: { ...DEFAULT_SETTINGS, ...settings }, leaf: own[0] ?? null, fruit: own[1] ?? null }
      return () => this.#putToGrow({ ...drawn, ...how, name: text.examples[name] ?? name })
    })
  }

  /** Open an example and grow it. */
  openExample({ name, photo, strokes }: Example): Promise<void> {
    return this.#opening(async () => {
      const [file, drawn] = await Promise.all([this.client.getFile(photo), this.client.getFile(strokes)])
      const history = begin(fromWire(await jsonOf(drawn)))
      const sheets = onPhoto(await this.#upload(file))
      return () => this.#putToGrow({ sheets, name: text.examples[name] ?? name, history })
    })
  }

  /** Open a drawing that the browser has kept, with the model that was grown of it. */
  openDraft(id: string): Promise<void> {
    return this.#opening(async () => {
      const found = await this.drafts.find(id)
      if (!found) throw new Unusable(text.faults.draftGone)
      const { draft, leaf, fruit } = found
      const settings = { ...DEFAULT_SETTINGS, ...draft.settings }
      const sheets = await this.#sheetsOf(found)
      const own = {
        leaf: draft.modelHadOtherLeaf ? FORGOTTEN : leaf,
        fruit: draft.modelHadOtherFruit ? FORGOTTEN : fruit,
      }
      return async () => {
        this.#put({ name: draft.name, history: draft.history, seed: draft.seed, sheets, settings, leaf, fruit }, id)
        const model = draft.model && (await this.#find(draft.model))
        if (model && draft.modelOf && this.drafts.id === id) this.grower.show(model, draft.modelOf, own)
      }
    })
  }

  /** Open a model with its strokes, to look at it and to refine it. */
  openModel(id: string): Promise<void> {
    return this.#opening(async () => {
      const model = await this.#find(id)
      if (!model) throw new Unusable(text.faults.modelGone)
      const project = await this.#read(await this.client.getFile(model.files.project!))
      const settings = { ...DEFAULT_SETTINGS, ...model.settings }
      const { leaf, fruit = null } = project
      const drawn = await this.#laidOut(project, file => this.#photoOf(model.photo, file))
      return () => {
        this.#put({ ...drawn, name: model.name, settings, seed: model.seed, leaf, fruit })
        this.grower.show(model, drawn.history.present, { leaf, fruit })
      }
    })
  }

  /** Go back to where a photo is chosen; the drawing is kept. */
  close(): void {
    this.grower.leave()
    this.drafts.begin(null)
    this.store.set(closed(this.store.state))
  }

  /** Bring what is to be opened, then put it in its place, unless something else was asked for or left meanwhile. */
  async #opening(bring: () => Promise<() => void | Promise<void>>): Promise<void> {
    const [turn, left] = [++this.#asked, this.drafts.id]
    const isLast = () => turn === this.#asked
    this.store.fault('photo', null)
    this.store.set({ opening: true })
    try {
      const put = await bring()
      if (isLast() && this.drafts.id === left) await put()
    } catch (error) {
      const fault = faultOf(error)
      if (isLast()) this.store.fault('photo', fault)
    } finally {
      if (isLast()) this.store.set({ opening: false })
    }
  }

  async #projectOf(project: Project, name: string): Promise<() => void> {
    const { settings, seed, leaf, fruit = null } = project
    const drawn = await this.#laidOut(project)
    return () => this.#put({ ...drawn, name, settings, seed, leaf, fruit })
  }

  #read(file: Blob): Promise<Project> {
    return readProject(file, picture => this.#sketchIn(picture))
  }

  #sketchIn(file: Blob): Promise<SketchFile> {
    return readSketch(file, this.client, this.store.state.limits)
  }

  #upload(file: Blob): Promise<PhotoSheet> {
    return uploaded(file, this.client, this.store.state.limits)
  }

  /** Return the sheets of a kept drawing; over a photo, tracing finds out whether the service still has it. */
  async #sheetsOf({ draft, photo: file, side: guide }: DraftWithPictures): Promise<Sheets> {
    const { photo, source = 'photo' } = draft
    const side = draft.side
      ? { ...sheetOfSize(draft.side), file: guide, url: guide && URL.createObjectURL(guide) }
      : null
    if (!file) return { source: 'sketch', front: sheetOfSize(photo), side }
    if (source === 'sketch') return { source, front: await this.#photoOf(photo.id, file), side }
    const url = await pictureOf(file, photo, `/v1/photos/${photo.id}/image`)
    return { source, front: { ...photo, id: photo.id!, file, url }, side }
  }

  /** Find a photo that the service had, or send its copy again. */
  async #photoOf(known: string | null, file: Blob): Promise<PhotoSheet> {
    if (known === null) return this.#upload(file)
    try {
      const { id, width, height, image } = await this.client.getPhoto(known)
      return { id, width, height, file, url: image }
    } catch (error) {
      if (!(error instanceof Refused)) throw error
      return this.#upload(file)
    }
  }

  async #find(id: string): Promise<Model | null> {
    try {
      return await this.client.getModel(id)
    } catch (error) {
      if (error instanceof Refused) return null
      throw error
    }
  }

  #putToGrow(drawing: Drawing): void {
    this.#put(drawing)
    void this.grower.grow()
  }

  #put(drawing: Drawing, draft: string | null = null): void {
    const { sheets, name, history } = drawing
    const { settings = DEFAULT_SETTINGS, seed = 0, leaf = null, fruit = null } = drawing
    this.grower.leave()
    this.drafts.begin(draft)
    const tool = history.present.crown || sheets.source === 'sketch' ? 'branch' : 'crown'
    const opened = { sheets, name, history, settings, seed, leaf, fruit, tool } as const
    this.store.set({ ...closed(this.store.state), opening: true, ...opened })
    this.#showCorrections(drawing.corrections ?? sheets.front.corrections)
  }

  #showCorrections(text = ''): void {
    this.store.set({ corrections: text ? { of: this.store.strokes, text } : null })
  }

  /** Open the sheets that strokes lie on; the front's strokes are fitted to the photo that lies under them. */
  async #laidOut(
    { photo: file, strokes, sizes = {}, corrections }: Drawn & Pick<Project, 'photo'>,
    send = (photo: Blob) => this.#upload(photo),
  ) {
    const size = sizes.front
    const side = sizes.side ? sheetOfSize(sizes.side) : null
    if (!size) return { sheets: onPhoto(await send(file!), side), history: begin(strokes), corrections }
    const front = file ? await send(file) : sheetOfSize(size)
    const fitted = withSheet(strokes, 'front', fittedTo(onSheet(strokes, 'front'), size, front))
    const sheets: Sheets = { source: 'sketch', front, side: side ?? paper(front.height) }
    return { sheets, history: begin(fitted), corrections }
  }
}

function onPhoto(front: PhotoSheet, side: Sheet | null = null): Sheets {
  return { source: 'photo', front, side }
}

async function jsonOf(file: Blob): Promise<unknown> {
  return JSON.parse(await file.text())
}

function stem(name: string): string {
  return name.replace(/\.\w+$/, '')
}
