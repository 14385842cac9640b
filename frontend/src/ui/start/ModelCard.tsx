import type { TargetedKeyboardEvent } from 'preact'
import { useEffect, useLayoutEffect, useRef, useState } from 'preact/hooks'
import type { Model } from '../../api/types'
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

interface Props {
  readonly model: Model
  /** Whether it gets the focus when it comes. */
  readonly focused: boolean
  open(): void
  rename(name: string): void
  remove(): void
}

/** Return a model's name in the gallery. */
export function nameOf(model: Model): string {
  return model.name || text.gallery.unnamed
}

/** A model in the gallery: its picture, its name, when it was grown, and what can be done with it. */
export function ModelCard({ model, focused, open, rename, remove }: Props) {
  const [renaming, setRenaming] = useState(false)
  const picture = useRef<HTMLButtonElement>(null)
  const pencil = useRef<HTMLButtonElement>(null)
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
      {renaming ? <NameField name={model.name} end={end} /> : <h3 class="card-name">{name}</h3>}
      <div class="card-foot">
        <time dateTime={model.created} title={new Date(model.created).toLocaleString(LANGUAGE)}>
          {ago(Date.parse(model.created))}
        </time>
        <div class="card-tools">
          <IconButton
            label={text.gallery.rename(name)}
            icon={ICONS.pencil}
            ref={pencil}
            onClick={() => setRenaming(true)}
          />
          <Download model={model} />
          <IconButton label={text.gallery.remove(name)} icon={ICONS.remove} onClick={remove} />
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

interface NameFieldProps {
  readonly name: string
  /** Called with what was written, or null where the name stays, and whether the focus goes back. */
  end(written: string | null, refocus: boolean): void
}

/** The field in the place of a name: Enter and leaving it keep what is written, Escape does not. */
function NameField({ name, end }: NameFieldProps) {
  const field = useRef<HTMLInputElement>(null)
  const over = useRef(false)
  const longest = useStore(({ limits }) => limits?.name_length ?? LONGEST_NAME)
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
      defaultValue={name}
      maxLength={longest}
      aria-label={text.gallery.name}
      ref={field}
      onBlur={() => leave(true, false)}
      onKeyDown={press}
    />
  )
}
