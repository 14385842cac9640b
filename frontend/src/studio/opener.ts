import { type Client, Refused } from '../api/client'
import { begin, type History } from '../history'
import { fittedTo, paper, sheetOfSize } from '../sheets'
import { DEFAULT_SETTINGS, EMPTY, type Ground, type Model, type Photo, type State, type Store } from '../state'
import { fromWire, NO_STROKES, onSheet, type Strokes, withSheet } from '../strokes'
import { text } from '../text'
import type { Example, SketchExample } from './examples'
import type { Grower } from './grower'
import type { Keeper, Kept } from './keeper'
import { pictureOf, uploaded } from './photos'
import { isProject, type Project, readProject } from './project'
import { faultOf, Unusable } from './sentences'
import { sketchFrom } from './sketches'

/** What takes the place of the present drawing. */
interface Drawing extends Partial<Pick<State, 'source' | 'side' | 'settings' | 'seed' | 'leaf' | 'fruit'>> {
  readonly photo: Ground
  readonly name: string
  readonly history: History<Strokes>
}

/** In the place of a picture that is no longer known: another than any. */
const FORGOTTEN = new Blob([])

/** Opens photos, paper, projects, examples, drawings and models; what was open before stays until that has worked. */
export class Opener {
  constructor(
    private readonly store: Store,
    private readonly client: Client,
    private readonly keeper: Keeper,
    private readonly grower: Grower,
  ) {}

  /** Open a photo or a project that was chosen, dropped or pasted. */
  openFile(file: File): Promise<void> {
    return this.#opening(async () => {
      if (isProject(file)) return this.#openProject(await readProject(file), file.name)
      this.#put({ photo: await this.#upload(file), name: stem(file.name), history: begin(NO_STROKES) })
    })
  }

  /** Open two white sheets. */
  openPaper(): Promise<void> {
    return this.#opening(async () => {
      this.#put({ source: 'sketch', photo: paper(), side: paper(), name: '', history: begin(NO_STROKES) })
    })
  }

  /** Open an example that was drawn on paper, and grow it. */
  openSketches({ name, front, side, leaf, fruit, settings }: SketchExample): Promise<void> {
    return this.#opening(async () => {
      const bring = async (url: string | undefined) => (url ? await this.client.getFile(url) : null)
      const [ahead, left, ...own] = await Promise.all([front, side, leaf, fruit].map(bring))
      const [one, other] = await Promise.all([ahead, left].map(async file => file && sketchFrom(await jsonOf(file))))
      const history = begin(other ? withSheet(one!.strokes, 'side', other.strokes) : one!.strokes)
      const sheets = { photo: sheetOfSize(one!.size), side: other ? sheetOfSize(other.size) : paper(one!.size.height) }
      const pictures = { leaf: own[0] ?? null, fruit: own[1] ?? null }
      const how = { settings: { ...DEFAULT_SETTINGS, ...settings }, ...pictures }
      this.#put({ source: 'sketch', ...sheets, name: text.examples[name] ?? name, history, ...how })
      void this.grower.grow()
    })
  }

  /** Open an example and grow it. */
  openExample({ name, photo, strokes }: Example): Promise<void> {
    return this.#opening(async () => {
      const [file, drawn] = await Promise.all([this.client.getFile(photo), this.client.getFile(strokes)])
      const history = begin(fromWire(await jsonOf(drawn)))
      this.#put({ photo: await this.#upload(file), name: text.examples[name] ?? name, history })
      void this.grower.grow()
    })
  }

  /** Open a drawing that the browser has kept, with the model that was grown of it. */
  openDraft(id: string): Promise<void> {
    return this.#opening(async () => {
      const found = await this.keeper.find(id)
      if (!found) throw new Unusable(text.faults.draftGone)
      const { draft, leaf, fruit } = found
      const settings = { ...DEFAULT_SETTINGS, ...draft.settings }
      this.#put({ ...draft, ...(await this.#sheetsOf(found)), settings, leaf, fruit }, id)
      const model = draft.model && (await this.#find(draft.model))
      const own = {
        leaf: draft.modelHadOtherLeaf ? FORGOTTEN : leaf,
        fruit: draft.modelHadOtherFruit ? FORGOTTEN : fruit,
      }
      if (model && draft.modelOf) this.grower.show(model, draft.modelOf, own)
    })
  }

  /** Open a model with its strokes, to look at it and to refine it. */
  openModel(id: string): Promise<void> {
    return this.#opening(async () => {
      const model = await this.#find(id)
      if (!model) throw new Unusable(text.faults.modelGone)
      const project = await readProject(await this.client.getFile(model.files.project!))
      const settings = { ...DEFAULT_SETTINGS, ...model.settings }
      const { leaf, fruit = null } = project
      const { strokes, ...sheets } = await laidOut(project, file => this.#photoOf(model.photo, file))
      this.#put({ ...sheets, name: model.name, history: begin(strokes), settings, seed: model.seed, leaf, fruit })
      this.grower.show(model, strokes, { leaf, fruit })
    })
  }

  /** Go back to where a photo is chosen; the drawing is kept. */
  close(): void {
    this.grower.leave()
    this.keeper.begin(null)
    this.store.set({ ...EMPTY, limits: this.store.state.limits })
  }

  async #opening(open: () => Promise<void>): Promise<void> {
    if (this.store.state.opening) return
    this.store.fault('photo', null)
    this.store.set({ opening: true })
    try {
      await open()
    } catch (error) {
      this.store.fault('photo', faultOf(error))
    } finally {
      this.store.set({ opening: false })
    }
  }

  async #openProject(project: Project, name: string): Promise<void> {
    const { settings, seed, leaf, fruit = null } = project
    const { strokes, ...sheets } = await laidOut(project, file => this.#upload(file))
    this.#put({ ...sheets, name: stem(name), history: begin(strokes), settings, seed, leaf, fruit })
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

  #put(drawing: Drawing, draft: string | null = null): void {
    const { source = 'photo', side = null, photo, name, history } = drawing
    const { settings = DEFAULT_SETTINGS, seed = 0, leaf = null, fruit = null } = drawing
    const { limits, online } = this.store.state
    this.grower.leave()
    this.keeper.begin(draft)
    const tool = history.present.crown || source === 'sketch' ? 'branch' : 'crown'
    const opened = { source, photo, side, name, history, settings, seed, leaf, fruit, tool } as const
    this.store.set({ ...EMPTY, limits, online, opening: true, ...opened })
  }
}

/** Lay a project's strokes on their sheets; those of the front go with the photo that lies under them. */
async function laidOut({ photo: file, strokes, sheets = {} }: Project, send: (file: Blob) => Promise<Photo>) {
  const { front, side } = sheets
  const photo = file ? await send(file) : sheetOfSize(front!)
  const left = side ? sheetOfSize(side) : front ? paper(photo.height) : null
  const moved = front ? withSheet(strokes, 'front', fittedTo(onSheet(strokes, 'front'), front, photo)) : strokes
  return { source: front ? ('sketch' as const) : ('photo' as const), photo, side: left, strokes: moved }
}

async function jsonOf(file: Blob): Promise<unknown> {
  return JSON.parse(await file.text())
}

function stem(name: string): string {
  return name.replace(/\.\w+$/, '')
}
