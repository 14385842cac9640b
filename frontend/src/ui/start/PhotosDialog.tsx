import { useEffect, useMemo } from 'preact/hooks'
import type { Limits } from '../../api/types'
import { captureOf } from '../../sheets'
import type { Offer } from '../../state'
import { text } from '../../text'
import { mayLeave } from '../parts/files'
import { useStore, useStudio } from '../parts/useStore'
import { Dialog } from './Dialog'
import './photosDialog.css'

const { offer: words } = text.capture
const CLOSED = { dialog: null, offer: null }

/** Says what becomes of several photos before anything is sent: one tree of all of them, or of one alone. */
export function PhotosDialog() {
  const offer = useStore(state => state.offer)
  if (!offer) return null
  return (
    <Dialog title={words.title(offer.photos.length)} class="photos-dialog" after={CLOSED}>
      <Choice offer={offer} />
    </Dialog>
  )
}

function Choice({ offer }: { readonly offer: Offer }) {
  const { photos, others } = offer
  const limits = useStore(state => state.limits)
  const isOpen = useStore(state => captureOf(state) !== null)
  const wrong = faultIn(photos.length, limits)
  return (
    <>
      {wrong ? (
        <p class="fault">{wrong}</p>
      ) : (
        <>
          <p>{words.what}</p>
          <p class="soft">{words.how}</p>
        </>
      )}
      {others.length > 0 && <p class="soft">{words.others(others)}</p>}
      <StartButtons offer={offer} canStart={!wrong} canAdd={isOpen} />
      <p class="photos-one">{words.one}</p>
      <ul class="photos-grid">
        {photos.map(photo => (
          <PhotoChoice key={photo} photo={photo} />
        ))}
      </ul>
    </>
  )
}

interface StartProps {
  readonly offer: Offer
  readonly canStart: boolean
  readonly canAdd: boolean
}

function StartButtons({ offer: { photos, name }, canStart, canAdd }: StartProps) {
  const studio = useStudio()
  const { opener, captures, store } = studio
  const start = () => {
    if (!mayLeave(studio)) return
    store.set(CLOSED)
    void opener.openPhotos(photos, name)
  }
  const add = () => {
    store.set(CLOSED)
    void captures.add(photos)
  }
  return (
    <div class="photos-start">
      {canAdd && (
        <button type="button" class="button primary" onClick={add}>
          {words.add(photos.length)}
        </button>
      )}
      {canStart && (
        <button type="button" class={canAdd ? 'button outlined' : 'button primary'} onClick={start}>
          {words.start(photos.length)}
        </button>
      )}
      <button type="button" class="button outlined" onClick={() => store.set({ dialog: 'advice' })}>
        {text.capture.status.advice}
      </button>
    </div>
  )
}

/** One of the photos, which can be opened alone. */
function PhotoChoice({ photo }: { readonly photo: File }) {
  const studio = useStudio()
  const url = useMemo(() => URL.createObjectURL(photo), [photo])
  useEffect(() => () => URL.revokeObjectURL(url), [url])
  const open = () => {
    if (!mayLeave(studio)) return
    studio.store.set(CLOSED)
    void studio.opener.openFile(photo)
  }
  return (
    <li>
      <button type="button" class="photos-photo" title={words.openOne(photo.name)} onClick={open}>
        <img src={url} alt="" loading="lazy" decoding="async" />
        <span class="visually-hidden">{words.openOne(photo.name)}</span>
        <span aria-hidden="true">{photo.name}</span>
      </button>
    </li>
  )
}

/** Return what is wrong with so many photos as one tree; null where nothing is. */
function faultIn(count: number, limits: Limits | null): string | null {
  if (!limits) return null
  const { capture_photos_min: least, capture_photos_max: most } = limits
  if (count < least) return words.tooFew(count, least)
  return count > most ? words.tooMany(count, most) : null
}
