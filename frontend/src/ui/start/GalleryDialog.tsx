import { useEffect, useLayoutEffect, useRef, useState } from 'preact/hooks'
import { lookingOnly } from '../../access'
import { isFinished } from '../../api/follow'
import type { Model, Session } from '../../api/types'
import { Gallery } from '../../studio/gallery'
import { text } from '../../text'
import { Sapling } from '../parts/Sapling'
import { useStore, useStudio } from '../parts/useStore'
import { Dialog } from './Dialog'
import { ModelCard, type Narrowed, nameOf } from './ModelCard'
import './gallery.css'

const LOOK_MS = 2000
/** How long nothing must be typed before it is searched for. */
const TYPING_MS = 300

/** A model in the gallery; a deleted one leaves its place to an undo. */
interface Entry {
  readonly model: Model
  readonly deleted: boolean
}

type Change = (id: string, changed: Partial<Entry>) => void

/** One's trees, or those of one's team: to open, rename, download and delete. */
export function GalleryDialog() {
  const isShared = useStore(({ session }) => session !== null)
  return (
    <Dialog title={isShared ? text.gallery.teamTitle : text.gallery.title} class="gallery-dialog">
      <Models />
    </Dialog>
  )
}

function Models() {
  const { store, client, grower } = useStudio()
  const [gallery] = useState(() => new Gallery(store, client, grower))
  const [words, setWords] = useState('')
  const [narrowed, setNarrowed] = useState<Narrowed | null>(null)
  const { entries, page, load, change } = usePages(gallery, words, narrowed)
  const [focused, setFocused] = useState<string | null>(null)
  const list = useRef<HTMLUListElement>(null)
  const fault = useStore(({ faults }) => faults.gallery)
  /** The button that was pressed may vanish: the focus goes on to what it brought. */
  const loadAndFocus = async () => {
    const models = await load()
    if (models?.[0]) setFocused(models[0].id)
    else if (models) list.current?.closest('dialog')?.querySelector('button')?.focus()
  }
  return (
    <div class="gallery">
      <SearchField setWords={setWords} narrowed={narrowed} widen={() => setNarrowed(null)} />
      <div class="fault gallery-fault" hidden={!fault}>
        <p role="alert">{fault?.text}</p>
        <button type="button" class="button outlined" hidden={page === 'loaded'} onClick={loadAndFocus}>
          {text.gallery.again}
        </button>
      </div>
      <ul class="cards" ref={list}>
        {entries.map(({ model, deleted }) => {
          const one = { key: model.id, model, gallery, change }
          return deleted ? (
            <DeletedModel {...one} focus={setFocused} />
          ) : (
            <ListedModel {...one} focused={focused === model.id} narrow={setNarrowed} />
          )
        })}
      </ul>
      <p class="gallery-empty" hidden={page !== 'loaded' || entries.length > 0}>
        <Sapling />
        {words || narrowed ? text.gallery.nothing : text.gallery.empty}
      </p>
      <p class="gallery-loading" role="status" hidden={page !== 'loading'}>
        {text.gallery.loading}
      </p>
      <button type="button" class="button outlined gallery-more" hidden={!gallery.hasMore} onClick={loadAndFocus}>
        {text.gallery.more}
      </button>
    </div>
  )
}

interface SearchProps {
  readonly narrowed: Narrowed | null
  setWords(words: string): void
  widen(): void
}

/** The field with the words that are looked for, and the tag or the person to which the gallery is narrowed. */
function SearchField({ narrowed, setWords, widen }: SearchProps) {
  const timer = useRef<ReturnType<typeof setTimeout> | undefined>(undefined)
  useEffect(() => () => clearTimeout(timer.current), [])
  const type = (words: string) => {
    clearTimeout(timer.current)
    timer.current = setTimeout(() => setWords(words.trim()), TYPING_MS)
  }
  return (
    <div class="gallery-search" role="search">
      <input
        type="search"
        aria-label={text.gallery.search}
        placeholder={text.gallery.search}
        onInput={event => type(event.currentTarget.value)}
      />
      <button type="button" class="button outlined" hidden={!narrowed} onClick={widen}>
        {text.gallery.found(narrowed?.shown ?? '')}
      </button>
    </div>
  )
}

/** Load the models that are looked for page by page, and look again and again how those under way are. */
function usePages(gallery: Gallery, words: string, narrowed: Narrowed | null) {
  const { store } = useStudio()
  const [entries, setEntries] = useState<readonly Entry[]>([])
  const [page, setPage] = useState<'loading' | 'loaded' | 'failed'>('loading')
  const load = async () => {
    setPage('loading')
    const models = await gallery.more()
    setPage(models ? 'loaded' : 'failed')
    setEntries(now => [...now, ...(models ?? []).map(model => ({ model, deleted: false }))])
    return models
  }
  useEffect(() => {
    store.fault('gallery', null)
    setEntries([])
    gallery.search({ q: words, ...(narrowed && { [narrowed.by]: narrowed.value }) })
    void load()
  }, [words, narrowed])
  useEffect(() => {
    const growing = entries.filter(({ model, deleted }) => !deleted && !isFinished(model))
    if (!growing.length) return
    const look = async () => {
      const found = await Promise.all(growing.map(({ model }) => gallery.refresh(model)))
      const latest = new Map(found.map(model => [model?.id, model]))
      setEntries(now => now.map(entry => ({ ...entry, model: latest.get(entry.model.id) ?? entry.model })))
    }
    const timer = setTimeout(look, LOOK_MS)
    return () => clearTimeout(timer)
  }, [entries])
  const change: Change = (id, changed) =>
    setEntries(now => now.map(entry => (entry.model.id === id ? { ...entry, ...changed } : entry)))
  return { entries, page, load, change }
}

interface EntryProps {
  readonly model: Model
  readonly gallery: Gallery
  readonly change: Change
}

interface ListedProps extends EntryProps {
  readonly focused: boolean
  narrow(wanted: Narrowed): void
}

function ListedModel({ model, gallery, change, focused, narrow }: ListedProps) {
  const { store, opener } = useStudio()
  const session = useStore(state => state.session)
  const open = () => {
    store.set({ dialog: null })
    void opener.openModel(model.id)
  }
  const rename = async (name: string) => {
    const renamed = await gallery.rename(model.id, name)
    if (renamed) change(model.id, { model: renamed })
  }
  const remove = async () => {
    if (!(await gallery.remove(model.id))) return
    change(model.id, { deleted: true })
    store.announce(text.gallery.removed(nameOf(model)))
  }
  const tag = async (tags: readonly string[]) => {
    const tagged = await gallery.tag(model.id, tags)
    if (tagged) change(model.id, { model: tagged })
  }
  const may = rightsIn(session, model)
  return <ModelCard {...{ model, focused, may, open, rename, tag, remove, narrow }} />
}

/** Tell what one may do with a model: owners all, members delete their own, viewers and read-only keys nothing. */
function rightsIn(session: Session | null, { maker }: Model): { change: boolean; remove: boolean } {
  const change = lookingOnly(session) === null
  const { role, id } = session?.member ?? { role: 'owner', id: null }
  return { change, remove: change && (role === 'owner' || maker?.id === id) }
}

/** The place of a deleted model, with the button that brings it back. */
function DeletedModel({ model, gallery, change, focus }: EntryProps & { focus(id: string): void }) {
  const { store } = useStudio()
  const undo = useRef<HTMLButtonElement>(null)
  useLayoutEffect(() => undo.current!.focus(), [])
  const restore = async () => {
    const restored = await gallery.restore(model.id)
    if (!restored) return
    focus(model.id)
    change(model.id, { model: restored, deleted: false })
    store.announce(text.gallery.restored(nameOf(model)))
  }
  return (
    <li class="card is-deleted">
      <p>{text.gallery.removed(nameOf(model))}</p>
      <button type="button" class="button outlined" ref={undo} onClick={restore}>
        {text.gallery.undo}
      </button>
    </li>
  )
}
