import type { TargetedKeyboardEvent } from 'preact'
import { useEffect, useLayoutEffect, useRef, useState } from 'preact/hooks'
import type { CapturePhoto } from '../../api/types'
import { captureOf, photoDrawnOn } from '../../sheets'
import { photosDrawnOver } from '../../strokes'
import { text } from '../../text'
import { Icon } from '../parts/Icon'
import { ICONS } from '../parts/icons'
import { placeAfter } from '../parts/placeAfter'
import { useLoaded } from '../parts/useLoaded'
import { useStore, useStudio } from '../parts/useStore'
import { CaptureStatus } from './CaptureStatus'
import './photoStrip.css'

const { strip: words } = text.capture

/** The many photos of a tree below the one that is drawn on: what becomes of them, and which is drawn on. */
export function PhotoStrip() {
  const capture = useStore(captureOf)
  if (!capture) return null
  const { photos, chosen } = capture
  return (
    <div class="photo-strip">
      <CaptureStatus />
      <Photos photos={photos} awaited={Math.max(chosen - photos.length, 0)} />
    </div>
  )
}

interface PhotosProps {
  readonly photos: readonly CapturePhoto[]
  /** How many more are to come. */
  readonly awaited: number
}

/** The photos in a row; arrow keys go from one to the next, which is drawn on then. */
function Photos({ photos, awaited }: PhotosProps) {
  const { captures } = useStudio()
  const chosen = useStore(photoDrawnOn)
  const strokes = useStore(({ history }) => history.present)
  const [pointedAt, pointAt] = useState<string | null>(null)
  const row = useRef<HTMLDivElement>(null)
  useLayoutEffect(() => {
    const own = row.current!.querySelector('[aria-checked="true"]')
    own?.scrollIntoView?.({ block: 'nearest', inline: 'nearest' })
  }, [chosen, photos.length])
  const drawnOver = new Set(photosDrawnOver(strokes))
  const step = (event: TargetedKeyboardEvent<HTMLElement>) => {
    const at = photos.findIndex(({ name }) => name === chosen)
    const next = placeAfter(event.key, at, photos.length)
    if (next === undefined) return
    event.preventDefault()
    event.stopPropagation()
    captures.choose(photos[next]!.name)
    ;(event.currentTarget.children[next] as HTMLElement).focus()
  }
  const noted = photos.find(({ name }) => name === (pointedAt ?? chosen))
  return (
    <>
      <div class="strip-photos" role="radiogroup" aria-label={words.label} onKeyDown={step} ref={row}>
        {photos.map((photo, at) => (
          <PhotoButton
            key={photo.id}
            photo={photo}
            label={labelOf(photo, words.photo(at + 1, photos.length, photo.name), drawnOver.has(photo.name))}
            isChosen={photo.name === chosen}
            isDrawn={drawnOver.has(photo.name)}
            pointAt={pointAt}
          />
        ))}
        {Array.from({ length: awaited }, (_, at) => (
          <span key={at} class="strip-awaited" aria-hidden="true" />
        ))}
      </div>
      <p class="strip-note">{noted?.used === false ? words.notUsed(noted.name, reasonOf(noted)) : ''}</p>
    </>
  )
}

interface PhotoProps {
  readonly photo: CapturePhoto
  readonly label: string
  readonly isChosen: boolean
  readonly isDrawn: boolean
  pointAt(photo: string | null): void
}

function PhotoButton({ photo, label, isChosen, isDrawn, pointAt }: PhotoProps) {
  const { captures } = useStudio()
  const { name, used } = photo
  return (
    <button
      type="button"
      class={used === false ? 'strip-photo is-unused' : 'strip-photo'}
      role="radio"
      aria-checked={isChosen}
      aria-label={label}
      title={used === false ? words.notUsed(name, reasonOf(photo)) : name}
      tabIndex={isChosen ? 0 : -1}
      onClick={() => captures.choose(name)}
      onPointerEnter={() => pointAt(name)}
      onPointerLeave={() => pointAt(null)}
    >
      <Thumbnail photo={photo} />
      {isDrawn && <Badge icon={ICONS.pencil} kind="drawn" />}
      {used === false && <Badge icon={ICONS.cross} kind="unused" />}
    </button>
  )
}

function Badge({ icon, kind }: { readonly icon: (typeof ICONS)[keyof typeof ICONS]; readonly kind: string }) {
  return (
    <span class={`strip-badge ${kind}`}>
      <Icon path={icon} />
    </span>
  )
}

/** A photo's thumbnail, made when it first comes into view. */
function Thumbnail({ photo }: { readonly photo: CapturePhoto }) {
  const { thumbnails } = useStudio()
  const place = useRef<HTMLSpanElement>(null)
  const [isSeen, setSeen] = useState(false)
  useEffect(() => {
    const seeing = new IntersectionObserver(entries => {
      if (entries.some(({ isIntersecting }) => isIntersecting)) setSeen(true)
    })
    seeing.observe(place.current!)
    return () => seeing.disconnect()
  }, [])
  const url = useLoaded(async () => (isSeen ? thumbnails.of(photo) : null), [photo.id, isSeen])
  return (
    <span class="strip-picture" style={{ '--ratio': `${photo.width} / ${photo.height}` }} ref={place}>
      {url && <img src={url} alt="" />}
    </span>
  )
}

/** Return what a screen reader says of a photo: its place and name, whether it has strokes, whether it is used. */
function labelOf(photo: CapturePhoto, name: string, isDrawn: boolean): string {
  const use = photo.used === null ? words.pending : photo.used ? words.used : `${words.unused}: ${reasonOf(photo)}`
  return [name, ...(isDrawn ? [words.drawn] : []), use].join(', ')
}

function reasonOf({ reason }: CapturePhoto): string {
  return reason ? (words.reasons[reason.code] ?? reason.detail) : ''
}
