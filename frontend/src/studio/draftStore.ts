import { type DBSchema, type IDBPDatabase, openDB } from 'idb'
import type { Settings } from '../api/types'
import type { History } from '../history'
import { captureOf, clipOf, type Extent } from '../sheets'
import type { Capture, Clip, Sheets, Source, State, Store } from '../state'
import { isEmpty, type Strokes } from '../strokes'
import { Rounds } from './rounds'

/** Many photos as the browser keeps them. */
type DraftCapture = Pick<Capture, 'id' | 'photos' | 'chosen'>

/** A drawing as the browser keeps it. */
export interface Draft {
  readonly id: string
  /** Milliseconds since 1970. */
  readonly saved: number
  readonly name: string
  /** Absent in drawings over a photo. */
  readonly source?: Source
  /** The front's sheet, sheet px; without an id it has no photo on the service. */
  readonly photo: Extent & { readonly id: string | null }
  /** The side's sheet, sheet px, where it is open. */
  readonly side?: Extent | null
  /** Many photos, of which `photo` is the one that was drawn on. */
  readonly capture?: DraftCapture
  /** A clip, of which `photo` is the frame that was drawn on. */
  readonly clip?: Clip
  readonly history: History<Strokes>
  readonly settings: Settings
  readonly seed: number
  /** The id of the model that was last grown from it, and the strokes it was grown from. */
  readonly model: string | null
  readonly modelOf: Strokes | null
  /** Whether that model had another leaf or fruit than the draft now has. */
  readonly modelHadOtherLeaf?: boolean
  readonly modelHadOtherFruit?: boolean
}

/** A drawing's pictures: those under its sheets, and the own pictures of a leaf and a fruit. */
const PICTURES = ['photo', 'side', 'leaf', 'fruit'] as const
type Pictures = Readonly<Record<(typeof PICTURES)[number], Blob | null>>

/** A drawing with its pictures. */
export interface DraftWithPictures extends Pictures {
  readonly draft: Draft
}

interface DraftDatabase extends DBSchema {
  drafts: { key: string; value: Draft; indexes: { saved: number } }
  photos: { key: string; value: Blob }
}

const MAX_DRAFTS = 12
/** The parts of the state whose changes are saved. */
const KEYS = ['sheets', 'name', 'history', 'settings', 'seed', 'leaf', 'fruit', 'model'] as const

/** Saves each drawing in the browser as it is drawn, with its undo history: a reload or a crash loses nothing. */
export class DraftStore {
  #id: string | null = null
  /** The pictures of this drawing that have been saved; null before the first time. */
  #saved: Pictures | null = null
  readonly #rounds = new Rounds(() => this.#write(this.store.state))

  constructor(
    private readonly store: Store,
    private readonly database: Promise<IDBPDatabase<DraftDatabase>> = open(),
  ) {
    database.catch(() => store.set({ kept: false }))
    for (const key of KEYS)
      store.watch(
        state => state[key],
        () => this.#save(),
      )
  }

  /** The id of the draft that is open; null where none is. */
  get id(): string | null {
    return this.#id
  }

  /** Save what is drawn from now on as the draft with this id, or as a new one. */
  begin(id: string | null): void {
    this.#id = id ?? crypto.randomUUID()
    this.#saved = null
  }

  /** Return the drafts that have strokes, many photos or a clip, the latest first. */
  async list(): Promise<Draft[]> {
    const drafts = await (await this.database).getAllFromIndex('drafts', 'saved')
    return drafts.filter(({ history, capture, clip }) => capture || clip || !isEmpty(history.present)).reverse()
  }

  /** Return a draft with its pictures, of many photos and clips a thumbnail; null where it is gone. */
  async find(id: string): Promise<DraftWithPictures | null> {
    const database = await this.database
    const stored = PICTURES.map(async what => [what, (await database.get('photos', keyOf(id, what))) ?? null] as const)
    const [draft, ...pictures] = await Promise.all([database.get('drafts', id), ...stored])
    const found = Object.fromEntries(pictures) as Pictures
    if (draft?.capture || draft?.clip) return { draft, ...found, photo: await this.thumbnail(draft.photo.id ?? '', id) }
    return draft && (found.photo || draft.source === 'sketch') ? { draft, ...found } : null
  }

  async remove(id: string): Promise<void> {
    await removeAll(await this.database, [id])
  }

  /** Return the thumbnail of a photo of many, which belongs to a draft; null where none is kept. */
  async thumbnail(photo: string, draft = this.#id): Promise<Blob | null> {
    const database = await this.database
    return (draft && (await database.get('photos', thumbnailKey(draft, photo)))) || null
  }

  /** Keep the thumbnail of a photo of many with the open draft; without one it is dropped. */
  async keepThumbnail(photo: string, thumbnail: Blob): Promise<void> {
    if (!this.#id) return
    await (await this.database).put('photos', thumbnail, thumbnailKey(this.#id, photo))
  }

  /** Store a removed draft again. */
  async restore({ draft, ...pictures }: DraftWithPictures): Promise<void> {
    const database = await this.database
    await putPictures(database, draft.id, pictures, null)
    await database.put('drafts', draft)
  }

  async #save(): Promise<void> {
    try {
      await this.#rounds.ask()
    } catch {
      this.store.set({ kept: false }) // a private window, or a full disk: the page says so
    }
  }

  async #write(state: State): Promise<void> {
    const id = this.#id
    const { sheets, leaf, fruit } = state
    if (!id || !sheets) return
    const database = await this.database
    const before = this.#saved
    const pictures = { photo: sheets.front.file, side: sheets.side?.file ?? null, leaf, fruit }
    await putPictures(database, id, pictures, before)
    await database.put('drafts', draftOf({ ...state, sheets }, id))
    if (!before) await prune(database)
    if (this.#id === id) this.#saved = pictures
    if (!state.kept) this.store.set({ kept: true })
  }
}

function draftOf(state: State & { readonly sheets: Sheets }, id: string): Draft {
  const { name, history, settings, seed, model } = state
  const { source, front, side } = state.sheets
  const [capture, clip] = [captureOf(state), clipOf(state)]
  return {
    ...{ id, saved: Date.now(), source, name, history, settings, seed },
    photo: { id: front.id, width: front.width, height: front.height },
    side: side && { width: side.width, height: side.height },
    ...(capture && { capture: { id: capture.id, photos: capture.photos, chosen: capture.chosen } }),
    ...(clip && { clip }),
    model: model?.info.id ?? null,
    modelOf: model?.strokes ?? null,
    modelHadOtherLeaf: (model?.leaf ?? null) !== state.leaf,
    modelHadOtherFruit: (model?.fruit ?? null) !== state.fruit,
  }
}

/** Return the key under which a draft's picture is stored. */
function keyOf(id: string, what: keyof Pictures): string {
  return what === 'photo' ? id : `${id}/${what}`
}

function thumbnailKey(draft: string, photo: string): string {
  return `${draft}/${photo}`
}

/** Store the pictures that differ from those before; null before the first time. */
async function putPictures(
  database: IDBPDatabase<DraftDatabase>,
  id: string,
  pictures: Pictures,
  before: Pictures | null,
): Promise<void> {
  for (const what of PICTURES) {
    const picture = pictures[what]
    if (before && before[what] === picture) continue
    if (picture) await database.put('photos', picture, keyOf(id, what))
    else await database.delete('photos', keyOf(id, what))
  }
}

/** Open the database. Asynchronous, so that it rejects, not throws, in a browser without one. */
async function open(): Promise<IDBPDatabase<DraftDatabase>> {
  return openDB<DraftDatabase>('treestroke', 1, {
    upgrade(database) {
      database.createObjectStore('drafts', { keyPath: 'id' }).createIndex('saved', 'saved')
      database.createObjectStore('photos')
    },
  })
}

/** Remove the oldest drafts beyond the most that are kept. */
async function prune(database: IDBPDatabase<DraftDatabase>): Promise<void> {
  const ids = await database.getAllKeysFromIndex('drafts', 'saved')
  await removeAll(database, ids.slice(0, Math.max(0, ids.length - MAX_DRAFTS)))
}

async function removeAll(database: IDBPDatabase<DraftDatabase>, ids: readonly string[]): Promise<void> {
  const change = database.transaction(['drafts', 'photos'], 'readwrite')
  for (const id of ids) {
    change.objectStore('drafts').delete(id)
    change.objectStore('photos').delete(id)
    change.objectStore('photos').delete(IDBKeyRange.bound(`${id}/`, `${id}/\uffff`))
  }
  await change.done
}
