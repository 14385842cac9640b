import { type Client, Refused } from '../api/client'
import { begin, type History } from '../history'
import { DEFAULT_SETTINGS, EMPTY, type Model, type Photo, type Settings, type Store } from '../state'
import { fromWire, NO_STROKES, type Strokes } from '../strokes'
import { text } from '../text'
import type { Example } from './examples'
import type { Grower } from './grower'
import type { Keeper } from './keeper'
import { isProject, type Project, readProject } from './project'
import { faultOf, Unusable } from './sentences'

/** What takes the place of the present drawing. */
interface Drawing {
  readonly photo: Photo
  readonly name: string
  readonly history: History<Strokes>
  readonly settings?: Settings
  readonly seed?: number
  readonly leaf?: Blob | null
}

/** In the place of a leaf that is no longer known: another than any. */
const FORGOTTEN_LEAF = new Blob([])

/** Opens photos, projects, examples, kept drawings and models; what was open before stays until that has worked. */
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

  /** Open an example and grow it. */
  openExample({ name, photo, strokes }: Example): Promise<void> {
    return this.#opening(async () => {
      const [file, drawn] = await Promise.all([this.client.getFile(photo), this.client.getFile(strokes)])
      const history = begin(fromWire(JSON.parse(await drawn.text())))
      this.#put({ photo: await this.#upload(file), name: text.examples[name] ?? name, history })
      void this.grower.grow()
    })
  }

  /** Open a drawing that the browser has kept, with the model that was grown of it. */
  openDraft(id: string): Promise<void> {
    return this.#opening(async () => {
      const found = await this.keeper.find(id)
      if (!found) throw new Unusable(text.faults.draftGone)
      const { draft, photo: file, leaf } = found
      const url = await pictureOf(file, draft.photo, `/v1/photos/${draft.photo.id}/image`)
      const settings = { ...DEFAULT_SETTINGS, ...draft.settings }
      this.#put({ ...draft, photo: { ...draft.photo, file, url }, settings, leaf }, id)
      const model = draft.model && (await this.#find(draft.model))
      const modelLeaf = draft.modelHadOtherLeaf ? FORGOTTEN_LEAF : leaf
      if (model && draft.modelOf) this.grower.show(model, draft.modelOf, modelLeaf)
    })
  }

  /** Open a model with its strokes, to look at it and to refine it. */
  openModel(id: string): Promise<void> {
    return this.#opening(async () => {
      const model = await this.#find(id)
      if (!model) throw new Unusable(text.faults.modelGone)
      const { strokes, leaf, photo: file } = await readProject(await this.client.getFile(model.files.project!))
      const settings = { ...DEFAULT_SETTINGS, ...model.settings }
      const photo = await this.#photoOf(model, file)
      this.#put({ photo, name: model.name, history: begin(strokes), settings, seed: model.seed, leaf })
      this.grower.show(model, strokes, leaf)
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

  async #openProject({ photo, strokes, ...project }: Project, name: string): Promise<void> {
    this.#put({ photo: await this.#upload(photo), name: stem(name), history: begin(strokes), ...project })
  }

  async #upload(file: Blob): Promise<Photo> {
    const most = this.store.state.limits?.photo_bytes ?? Number.POSITIVE_INFINITY
    if (file.size > most) throw new Unusable(text.faults.photoTooLarge(file.size / 1e6, most / 1e6))
    const { id, width, height, image } = await this.client.addPhoto(file)
    return { id, width, height, file, url: await pictureOf(file, { width, height }, image) }
  }

  /** Find a model's photo, or send the model's own copy of it again. */
  async #photoOf(model: Model, file: Blob): Promise<Photo> {
    try {
      const { id, width, height, image } = await this.client.getPhoto(model.photo)
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
    const { photo, name, history, settings = DEFAULT_SETTINGS, seed = 0, leaf = null } = drawing
    const { limits, online } = this.store.state
    this.grower.leave()
    this.keeper.begin(draft)
    const tool = history.present.crown ? 'branch' : 'crown'
    this.store.set({ ...EMPTY, limits, online, opening: true, photo, name, history, settings, seed, leaf, tool })
  }
}

/** Give an address that shows the upright picture: the file itself where the browser sees it as the service does. */
async function pictureOf(file: Blob, size: { width: number; height: number }, stored: string): Promise<string> {
  if (file.type !== 'image/jpeg') return stored
  const picture = await createImageBitmap(file).catch(() => null)
  const alike = picture?.width === size.width && picture.height === size.height
  picture?.close()
  return alike ? URL.createObjectURL(file) : stored
}

function stem(name: string): string {
  return name.replace(/\.\w+$/, '')
}
