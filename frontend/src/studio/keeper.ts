import { type DBSchema, type IDBPDatabase, openDB } from 'idb'
import type { History } from '../history'
import type { Settings, State, Store } from '../state'
import { isEmpty, type Strokes } from '../strokes'
import { Rounds } from './rounds'

/** A drawing as the browser keeps it. */
export interface Draft {
  readonly id: string
  /** Milliseconds since 1970. */
  readonly saved: number
  readonly name: string
  readonly photo: { readonly id: string; readonly width: number; readonly height: number }
  readonly history: History<Strokes>
  readonly settings: Settings
  readonly seed: number
  /** The model that was grown of it last, and of which strokes. */
  readonly model: string | null
  readonly modelOf: Strokes | null
  /** Whether its leaf is another than the one that is kept here. */
  readonly modelHadOtherLeaf?: boolean
}

/** A drawing with its photo and, where it has one, the person's own leaf. */
export interface Kept {
  readonly draft: Draft
  readonly photo: Blob
  readonly leaf: Blob | null
}

interface Shelf extends DBSchema {
  drafts: { key: string; value: Draft; indexes: { saved: number } }
  photos: { key: string; value: Blob }
}

const KEPT = 12
const KEYS = ['photo', 'name', 'history', 'settings', 'seed', 'leaf', 'model', 'modelOf'] as const
const NO_LEAF = Symbol('no leaf was kept yet')

/** Keeps every drawing in the browser as it is drawn, with its undo history, so that a reload or a crash loses nothing. */
export class Keeper {
  #id: string | null = null
  #photo: Blob | null = null
  #leaf: Blob | null | typeof NO_LEAF = NO_LEAF
  readonly #rounds = new Rounds(() => this.#write(this.store.state))

  constructor(
    private readonly store: Store,
    private readonly shelf: Promise<IDBPDatabase<Shelf>> = open(),
  ) {
    shelf.catch(() => store.set({ kept: false }))
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
    this.#photo = null
    this.#leaf = NO_LEAF
  }

  /** List what is kept, the latest first; drawings without a stroke are not worth coming back to. */
  async list(): Promise<Draft[]> {
    const drafts = await (await this.shelf).getAllFromIndex('drafts', 'saved')
    return drafts.filter(({ history }) => !isEmpty(history.present)).reverse()
  }

  /** Find a drawing and its pictures. */
  async find(id: string): Promise<Kept | null> {
    const shelf = await this.shelf
    const pictures = [id, leafKey(id)].map(key => shelf.get('photos', key))
    const [draft, photo, leaf] = await Promise.all([shelf.get('drafts', id), ...pictures])
    return draft && photo ? { draft, photo, leaf: leaf ?? null } : null
  }

  async remove(id: string): Promise<void> {
    await removeAll(await this.shelf, [id])
  }

  /** Put a drawing back that was removed. */
  async restore({ draft, photo, leaf }: Kept): Promise<void> {
    const shelf = await this.shelf
    await shelf.put('photos', photo, draft.id)
    if (leaf) await shelf.put('photos', leaf, leafKey(draft.id))
    await shelf.put('drafts', draft)
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
    if (!id || !state.photo) return
    const { file, id: photo, width, height } = state.photo
    const shelf = await this.shelf
    const isNew = this.#photo !== file
    if (isNew) await shelf.put('photos', file, id)
    const { name, history, settings, seed, leaf, modelOf, modelLeaf } = state
    if (this.#leaf !== leaf) await putLeaf(shelf, id, leaf)
    await shelf.put('drafts', {
      ...{ id, saved: Date.now(), name, photo: { id: photo, width, height }, history, settings, seed, modelOf },
      ...{ model: state.model?.id ?? null, modelHadOtherLeaf: modelLeaf !== leaf },
    })
    if (isNew) await prune(shelf)
    if (this.#id === id) [this.#photo, this.#leaf] = [file, leaf]
    if (!state.kept) this.store.set({ kept: true })
  }
}

/** Under which key a drawing's leaf lies beside the photos. */
function leafKey(id: string): string {
  return `${id}/leaf`
}

async function putLeaf(shelf: IDBPDatabase<Shelf>, id: string, leaf: Blob | null): Promise<void> {
  if (leaf) await shelf.put('photos', leaf, leafKey(id))
  else await shelf.delete('photos', leafKey(id))
}

/** Asynchronous, so that a browser without a shelf rejects instead of throwing. */
async function open(): Promise<IDBPDatabase<Shelf>> {
  return openDB<Shelf>('treestroke', 1, {
    upgrade(shelf) {
      shelf.createObjectStore('drafts', { keyPath: 'id' }).createIndex('saved', 'saved')
      shelf.createObjectStore('photos')
    },
  })
}

/** Let the drawings go that were touched longest ago. */
async function prune(shelf: IDBPDatabase<Shelf>): Promise<void> {
  const ids = await shelf.getAllKeysFromIndex('drafts', 'saved')
  await removeAll(shelf, ids.slice(0, Math.max(0, ids.length - KEPT)))
}

async function removeAll(shelf: IDBPDatabase<Shelf>, ids: readonly string[]): Promise<void> {
  const change = shelf.transaction(['drafts', 'photos'], 'readwrite')
  for (const id of ids) {
    change.objectStore('drafts').delete(id)
    change.objectStore('photos').delete(id)
    change.objectStore('photos').delete(leafKey(id))
  }
  await change.done
}
