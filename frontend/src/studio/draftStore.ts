import { type DBSchema, type IDBPDatabase, openDB } from 'idb'
import type { Settings } from '../api/types'
import type { History } from '../history'
import type { Extent } from '../sheets'
import type { Sheets, Source, State, Store } from '../state'
import { isEmpty, type Strokes } from '../strokes'
import { Rounds } from './rounds'

/** A drawing as the browser keeps it. */
export interface Draft {
  readonly id: string
  /** Milliseconds since 1970. */
  readonly saved: number
  readonly name: string
  /** Absent in drawings over a photo. */
  readonly source?: Source
  /** The photo or paper; without an id the service knows of no photo. */
  readonly photo: Extent & { readonly id: string | null }
  /** The left side's sheet, where it is open. */
  readonly side?: Extent | null
  readonly history: History<Strokes>
  readonly settings: Settings
  readonly seed: number
  /** The model that was grown of it last, and of which strokes. */
  readonly model: string | null
  readonly modelOf: Strokes | null
  /** Whether its leaf and its fruit are others than those that are kept here. */
  readonly modelHadOtherLeaf?: boolean
  readonly modelHadOtherFruit?: boolean
}

/** The pictures of a drawing: under both sheets, and the person's own leaf and fruit. */
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

const KEPT = 12
const KEYS = ['sheets', 'name', 'history', 'settings', 'seed', 'leaf', 'fruit', 'model'] as const

/** Keeps every drawing in the browser as it is drawn, with its undo history, so that a reload or a crash loses nothing. */
export class DraftStore {
  #id: string | null = null
  /** What has been written of this drawing. */
  #written: Pictures | null = null
  readonly #rounds = new Rounds(() => this.#write(this.store.state))

  constructor(
    private readonly store: Store,
    private readonly database: Promise<IDBPDatabase<DraftDatabase>> = open(),
  ) {
    database.catch(() => store.set({ kept: false }))
    for (const key of KEYS)
      store.watch(
        state => state[key],
        () => this.#keep(),
      )
  }

  /** The drawing that is kept now; what is opened next is another one. */
  get id(): string | null {
    return this.#id
  }

  /** Go on with a kept drawing, or with a new one. */
  begin(id: string | null): void {
    this.#id = id ?? crypto.randomUUID()
    this.#written = null
  }

  /** List what is kept, the latest first; drawings without a stroke are not worth coming back to. */
  async list(): Promise<Draft[]> {
    const drafts = await (await this.database).getAllFromIndex('drafts', 'saved')
    return drafts.filter(({ history }) => !isEmpty(history.present)).reverse()
  }

  /** Find a drawing and its pictures. */
  async find(id: string): Promise<DraftWithPictures | null> {
    const database = await this.database
    const found = PICTURES.map(async what => [what, (await database.get('photos', keyOf(id, what))) ?? null] as const)
    const [draft, ...pictures] = await Promise.all([database.get('drafts', id), ...found])
    const stored = Object.fromEntries(pictures) as Pictures
    return draft && (stored.photo || draft.source === 'sketch') ? { draft, ...stored } : null
  }

  async remove(id: string): Promise<void> {
    await removeAll(await this.database, [id])
  }

  /** Put a drawing back that was removed. */
  async restore({ draft, ...pictures }: DraftWithPictures): Promise<void> {
    const database = await this.database
    await putPictures(database, draft.id, pictures, null)
    await database.put('drafts', draft)
  }

  async #keep(): Promise<void> {
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
    const before = this.#written
    const pictures = { photo: sheets.front.file, side: sheets.side?.file ?? null, leaf, fruit }
    await putPictures(database, id, pictures, before)
    await database.put('drafts', draftOf({ ...state, sheets }, id))
    if (!before) await prune(database)
    if (this.#id === id) this.#written = pictures
    if (!state.kept) this.store.set({ kept: true })
  }
}

function draftOf(state: State & { readonly sheets: Sheets }, id: string): Draft {
  const { name, history, settings, seed, model } = state
  const { source, front, side } = state.sheets
  return {
    ...{ id, saved: Date.now(), source, name, history, settings, seed },
    photo: { id: front.id, width: front.width, height: front.height },
    side: side && { width: side.width, height: side.height },
    model: model?.info.id ?? null,
    modelOf: model?.strokes ?? null,
    modelHadOtherLeaf: (model?.leaf ?? null) !== state.leaf,
    modelHadOtherFruit: (model?.fruit ?? null) !== state.fruit,
  }
}

/** Under which key a drawing's picture lies. */
function keyOf(id: string, what: keyof Pictures): string {
  return what === 'photo' ? id : `${id}/${what}`
}

/** Write the pictures that are others than before. */
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

/** Asynchronous, so that a browser without a database rejects instead of throwing. */
async function open(): Promise<IDBPDatabase<DraftDatabase>> {
  return openDB<DraftDatabase>('treestroke', 1, {
    upgrade(database) {
      database.createObjectStore('drafts', { keyPath: 'id' }).createIndex('saved', 'saved')
      database.createObjectStore('photos')
    },
  })
}

/** Let the drawings go that were touched longest ago. */
async function prune(database: IDBPDatabase<DraftDatabase>): Promise<void> {
  const ids = await database.getAllKeysFromIndex('drafts', 'saved')
  await removeAll(database, ids.slice(0, Math.max(0, ids.length - KEPT)))
}

async function removeAll(database: IDBPDatabase<DraftDatabase>, ids: readonly string[]): Promise<void> {
  const change = database.transaction(['drafts', 'photos'], 'readwrite')
  for (const id of ids) {
    change.objectStore('drafts').delete(id)
    for (const what of PICTURES) change.objectStore('photos').delete(keyOf(id, what))
  }
  await change.done
}
