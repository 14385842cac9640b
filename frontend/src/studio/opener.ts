import { type Client, Refused } from '../api/client'
import { DEFAULT_SETTINGS } from '../api/defaults'
import { begin, type History } from '../history'
import { fittedTo, groundOf, paper, sheetOfSize } from '../sheets'
import { EMPTY, type Ground, type Model, type Photo, type State, type Store } from '../state'
import { fromWire, NO_STROKES, onSheet, type SheetName, type Strokes, withSheet } from '../strokes'
import { text } from '../text'
import { redrawn } from './desk'
import type { Example, SketchExample } from './examples'
import type { Grower } from './grower'
import type { Keeper, Kept } from './keeper'
import { pictureOf, uploaded } from './photos'
import { isProject, type Project, readProject } from './project'
import { faultOf, Unusable } from './sentences'
import { type Drawn, paired, remarkOn, type SketchFile } from './sketches'
import { readSketch } from './sketchPicture'

/** What takes the place of the present drawing. */
interface Drawing extends Partial<Pick<State, 'source' | 'side' | 'settings' | 'seed' | 'leaf' | 'fruit'>> {
  readonly photo: Ground
  readonly name: string
  readonly history: History<Strokes>
  /** What was mended in reading it. */
  readonly remark?: string | undefined
}

/** In the place of a picture that is no longer known: another than any. */
const FORGOTTEN = new Blob([])

/** Opens photos, paper, projects, examples, drawings and models; what was open before stays until that has worked. */
export class Opener {
  /** Counts what was asked to be opened: the last wins, whatever takes longest. */
  #asked = 0

  constructor(
    private readonly store: Store,
    private readonly client: Client,
    private readonly keeper: Keeper,
    private readonly grower: Grower,
  ) {}

  /** Open a photo or a project that was chosen, dropped or pasted. */
  openFile(file: File): Promise<void> {
    return this.#opening(async () => {
      if (isProject(file)) return this.#projectOf(await this.#read(file), stem(file.name))
      const photo = await this.#upload(file)
      return () => this.#put({ photo, name: stem(file.name), history: begin(NO_STROKES) })
    })
  }

  /** Open two white sheets. */
  openPaper(): Promise<void> {
    return this.#opening(async () => () => {
      this.#put({ source: 'sketch', photo: paper(), side: paper(), name: '', history: begin(NO_STROKES) })
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
        if (!groundOf(this.store.state, sheet)) return
        this.store.set(redrawn(this.store.state, sheet, sketch))
        this.#remark(remarkOn(sheet, sketch))
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
      const ground = await this.#upload(file)
      return () => this.#putToGrow({ photo: ground, name: text.examples[name] ?? name, history })
    })
  }

  /** Open a drawing that the browser has kept, with the model that was grown of it. */
  openDraft(id: string): Promise<void> {
    return this.#opening(async () => {
      const found = await this.keeper.find(id)
      if (!found) throw new Unusable(text.faults.draftGone)
      const { draft, leaf, fruit } = found
      const settings = { ...DEFAULT_SETTINGS, ...draft.settings }
      const sheets = await this.#sheetsOf(found)
      const own = {
        leaf: draft.modelHadOtherLeaf ? FORGOTTEN : leaf,
        fruit: draft.modelHadOtherFruit ? FORGOTTEN : fruit,
      }
      return async () => {
        this.#put({ ...draft, ...sheets, settings, leaf, fruit }, id)
        const model = draft.model && (await this.#find(draft.model))
        if (model && draft.modelOf && this.keeper.id === id) this.grower.show(model, draft.modelOf, own)
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
    this.keeper.begin(null)
    this.store.set({ ...EMPTY, limits: this.store.state.limits })
  }

  /** Bring what is to be opened, then put it in its place, unless something else was asked for or left meanwhile. */
  async #opening(bring: () => Promise<() => void | Promise<void>>): Promise<void> {
    const [turn, left] = [++this.#asked, this.keeper.id]
    const isLast = () => turn === this.#asked
    this.store.fault('photo', null)
    this.store.set({ opening: true })
    try {
      const put = await bring()
      if (isLast() && this.keeper.id === left) await put()
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

  #upload(file: Blob): Promise<Photo> {
    return uploaded(file, this.client, this.store.state.limits)
  }

  /** Lay the sheets of a kept drawing out; over a photo, tracing finds out whether the service still has it. */
  async #sheetsOf({ draft, photo: file, side: guide }: Kept): Promise<Pick<State, 'side'> & { photo: Ground }> {
    const { photo, side } = draft
    const left = side ? { ...sheetOfSize(side), file: guide, url: guide && URL.createObjectURL(guide) } : null
    if (!file) return { photo: sheetOfSize(photo), side: left }
    if (draft.source === 'sketch') return { photo: await this.#photoOf(photo.id, file), side: left }
    const url = await pictureOf(file, photo, `/v1/photos/${photo.id}/image`)
    return { photo: { ...photo, file, url }, side: left }
  }

  /** Find a photo that the service had, or send its copy again. */
  async #photoOf(known: string | null, file: Blob): Promise<Photo> {
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
    const { source = 'photo', side = null, photo, name, history } = drawing
    const { settings = DEFAULT_SETTINGS, seed = 0, leaf = null, fruit = null } = drawing
    const { limits, online } = this.store.state
    this.grower.leave()
    this.keeper.begin(draft)
    const tool = history.present.crown || source === 'sketch' ? 'branch' : 'crown'
    const opened = { source, photo, side, name, history, settings, seed, leaf, fruit, tool } as const
    this.store.set({ ...EMPTY, limits, online, opening: true, ...opened })
    this.#remark(drawing.remark ?? photo.mended)
  }

  #remark(said = ''): void {
    this.store.set({ remark: said ? { of: this.store.strokes, text: said } : null })
  }

  /** Lay strokes out on their sheets; those of the front go with the photo that lies under them. */
  async #laidOut(
    { photo: file, strokes, sheets = {}, remark }: Drawn & Pick<Project, 'photo'>,
    send = (photo: Blob) => this.#upload(photo),
  ) {
    const { front, side } = sheets
    const photo: Ground = file ? await send(file) : sheetOfSize(front!)
    const left = side ? sheetOfSize(side) : front ? paper(photo.height) : null
    const moved = front ? withSheet(strokes, 'front', fittedTo(onSheet(strokes, 'front'), front, photo)) : strokes
    return {
      source: front ? ('sketch' as const) : ('photo' as const),
      photo,
      side: left,
      history: begin(moved),
      remark,
    }
  }
}

async function jsonOf(file: Blob): Promise<unknown> {
  return JSON.parse(await file.text())
}

function stem(name: string): string {
  return name.replace(/\.\w+$/, '')
}
