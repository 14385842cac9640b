import type { TargetedKeyboardEvent } from 'preact'
import { useEffect, useLayoutEffect, useRef, useState } from 'preact/hooks'
import type { Maker, Model } from '../../api/types'
import { fileName } from '../../studio/project'
import { text } from '../../text'
import { LANGUAGE } from '../../text/numbers'
import { Icon } from '../parts/Icon'
import { IconButton } from '../parts/IconButton'
import { ICONS } from '../parts/icons'
import { useStore } from '../parts/useStore'
import { drawThumbnail } from './thumbnail'
import { ago } from './when'

const LONGEST_NAME = 200
const [MOST_TAGS, LONGEST_TAG] = [20, 40]
const LONGEST_TAGS = MOST_TAGS * (LONGEST_TAG + 2)

interface Props {
  readonly model: Model
  /** Whether it gets the focus when it comes. */
  readonly focused: boolean
  /** Whether it may be named and tagged, and whether it may be deleted. */
  readonly may: { readonly change: boolean; readonly remove: boolean }
  open(): void
  rename(name: string): void
  tag(tags: readonly string[]): void
  remove(): void
  /** Shows only what has this tag, or was made by this person. */
  narrow(wanted: Narrowed): void
}

/** A tag, or somebody whose trees are looked for: the text by which they are shown. */
export interface Narrowed {
  readonly by: 'tag' | 'maker'
  readonly value: string
  readonly shown: string
}

/** Return a model's name in the gallery. */
export function nameOf(model: Model): string {
  return model.name || text.gallery.unnamed
}

/** A model in the gallery: its picture, its name, who grew it when, its tags, and what can be done with it. */
export function ModelCard({ model, focused, may, open, rename, tag, remove, narrow }: Props) {
  const [renaming, setRenaming] = useState(false)
  const picture = useRef<HTMLButtonElement>(null)
  const pencil = useRef<HTMLButtonElement>(null)
  const longest = useStore(({ limits }) => limits?.name_length ?? LONGEST_NAME)
  const name = nameOf(model)
  useLayoutEffect(() => {
    if (focused) picture.current!.focus()
  }, [focused])
  const end = (written: string | null, refocus: boolean) => {
    setRenaming(false)
    if (refocus) pencil.current!.focus()
    if (written !== null && written !== model.name) rename(written)
  }
  return (
    <li class="card">
      <button type="button" class="card-picture" aria-label={text.gallery.open(name)} ref={picture} onClick={open}>
        <Picture model={model} />
      </button>
      {renaming ? (
        <CardField label={text.gallery.name} value={model.name} longest={longest} end={end} />
      ) : (
        <h3 class="card-name">{name}</h3>
      )}
      <CardTags model={model} canChange={may.change} tag={tag} narrow={narrow} />
      <div class="card-foot">
        <time dateTime={model.created} title={new Date(model.created).toLocaleString(LANGUAGE)}>
          {ago(Date.parse(model.created))}
        </time>
        <MakerButton maker={model.maker ?? null} narrow={narrow} />
        <div class="card-tools">
          <IconButton
            label={text.gallery.rename(name)}
            icon={ICONS.pencil}
            hidden={!may.change}
            ref={pencil}
            onClick={() => setRenaming(true)}
          />
          <Download model={model} />
          <IconButton label={text.gallery.remove(name)} icon={ICONS.remove} hidden={!may.remove} onClick={remove} />
        </div>
      </div>
    </li>
  )
}

function Picture({ model }: { readonly model: Model }) {
  const url = model.files['preview.png']
  const canvas = useRef<HTMLCanvasElement>(null)
  const [broken, setBroken] = useState(false)
  useEffect(() => {
    if (url) drawThumbnail(canvas.current!, url).catch(() => setBroken(true))
  }, [url])
  if (broken) return <Icon path={ICONS.tree} />
  if (url) return <canvas class="card-thumbnail" ref={canvas} />
  return (
    <span class="card-status">
      <Icon path={ICONS.tree} />
      {statusOf(model)}
    </span>
  )
}

function statusOf({ status, progress }: Model): string {
  if (status === 'succeeded') return ''
  if (status === 'running') return text.gallery.growing(Math.floor(progress * 100) / 100)
  return text.gallery.status[status]
}

function Download({ model }: { readonly model: Model }) {
  const href = model.files['tree.glb']
  const label = text.gallery.download(nameOf(model))
  if (!href) return null
  return (
    <a class="button square" href={href} download={fileName(model.name, '.glb')} aria-label={label} title={label}>
      <Icon path={ICONS.download} />
    </a>
  )
}

/** Who made a model, which shows all of theirs; nobody where nobody signs in. */
function MakerButton({ maker, narrow }: { readonly maker: Maker | null } & Pick<Props, 'narrow'>) {
  if (!maker) return null
  const shown = maker.name || text.gallery.somebody
  return (
    <button
      type="button"
      class="card-maker"
      title={text.gallery.onlyBy(shown)}
      onClick={() => narrow({ by: 'maker', value: maker.id, shown: text.gallery.by(shown) })}
    >
      {text.gallery.by(shown)}
    </button>
  )
}

/** A model's tags, each of which shows all models that have it, and the field in which they are changed. */
function CardTags({
  model,
  canChange,
  tag,
  narrow,
}: { readonly model: Model; readonly canChange: boolean } & Pick<Props, 'tag' | 'narrow'>) {
  const [isOpen, setOpen] = useState(false)
  const opener = useRef<HTMLButtonElement>(null)
  const tags = model.tags ?? []
  const end = (written: string | null, refocus: boolean) => {
    setOpen(false)
    if (refocus) opener.current!.focus()
    if (written !== null && written !== tags.join(', ')) tag(tagsIn(written))
  }
  return (
    <div class="card-tags" hidden={!tags.length && !canChange}>
      {isOpen ? (
        <CardField label={text.gallery.tags} value={tags.join(', ')} longest={LONGEST_TAGS} end={end} />
      ) : (
        tags.map(one => (
          <button
            type="button"
            class="card-tag"
            key={one}
            title={text.gallery.onlyTagged(one)}
            onClick={() => narrow({ by: 'tag', value: one, shown: one })}
          >
            {one}
          </button>
        ))
      )}
      <IconButton
        label={text.gallery.tagsOf(nameOf(model))}
        icon={ICONS.plus}
        hidden={!canChange}
        ref={opener}
        onClick={() => setOpen(true)}
      />
    </div>
  )
}

/** Return the tags that were written with commas between them. */
export function tagsIn(written: string): string[] {
  return [...new Set(written.split(',').flatMap(tag => tag.trim().slice(0, LONGEST_TAG) || []))].slice(0, MOST_TAGS)
}

interface FieldProps {
  readonly label: string
  readonly value: string
  /** How many characters it takes. */
  readonly longest: number
  /** Called with what was written, or null where all stays, and whether the focus goes back. */
  end(written: string | null, refocus: boolean): void
}

/** The field in the place of a text: Enter and leaving it keep what is written, Escape does not. */
function CardField({ label, value, longest, end }: FieldProps) {
  const field = useRef<HTMLInputElement>(null)
  const over = useRef(false)
  useLayoutEffect(() => {
    field.current!.focus()
    field.current!.select()
  }, [])
  const leave = (keep: boolean, refocus: boolean) => {
    if (over.current) return
    over.current = true
    end(keep ? field.current!.value.trim() : null, refocus)
  }
  const press = (event: TargetedKeyboardEvent<HTMLInputElement>) => {
    if (event.key !== 'Enter' && event.key !== 'Escape') return
    event.preventDefault() // Escape would close the gallery
    leave(event.key === 'Enter', true)
  }
  return (
    <input
      class="card-field"
      defaultValue={value}
      maxLength={longest}
      aria-label={label}
      ref={field}
      onBlur={() => leave(true, false)}
      onKeyDown={press}
    />
  )
}
