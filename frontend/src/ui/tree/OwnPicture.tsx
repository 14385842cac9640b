import { useLayoutEffect, useRef, useState } from 'preact/hooks'
import type { OwnPictures } from '../../state'
import { text } from '../../text'
import { useStore, useStudio } from '../parts/useStore'

/** The row in which a person's own picture of a leaf or a fruit is chosen, seen, replaced and removed. */
export function OwnPicture({ kind }: { readonly kind: keyof OwnPictures }) {
  const { store, ownPictures } = useStudio()
  const picture = useStore(state => state[kind])
  const fault = useStore(state => state.faults[kind])
  const url = useObjectUrl(picture)
  const pick = useRef<HTMLButtonElement>(null)
  const words = text.settings.ownPictures[kind]
  const id = `setting-${kind}`
  const take = async (file: File) => {
    await ownPictures.use(file, kind)
    if (!store.state.faults[kind]) store.announce(words.added)
  }
  const remove = () => {
    pick.current?.focus()
    ownPictures.remove(kind)
    store.announce(words.removed)
  }
  return (
    <div class="setting" role="group" aria-labelledby={id}>
      <span class="setting-label" id={id}>
        {words.label}
      </span>
      <div class="setting-entry">
        <img class="own-picture" alt={words.shown} src={url} hidden={picture === null} />
        <button
          type="button"
          class="button outlined"
          aria-describedby={`${id}-why`}
          ref={pick}
          onClick={() => choosePng(file => void take(file))}
        >
          {picture ? text.settings.ownPictures.replace : words.choose}
        </button>
        <button type="button" class="button outlined" hidden={picture === null} onClick={remove}>
          {text.settings.ownPictures.remove}
        </button>
      </div>
      <p class="setting-why" id={`${id}-why`}>
        {words.why}
      </p>
      <p class="setting-wrong" role="alert">
        {fault?.text}
      </p>
    </div>
  )
}

/** Return where a blob can be shown from, as long as it is shown. */
function useObjectUrl(blob: Blob | null): string | undefined {
  const [url, setUrl] = useState<string>()
  useLayoutEffect(() => {
    if (!blob) return
    const made = URL.createObjectURL(blob)
    setUrl(made)
    return () => {
      URL.revokeObjectURL(made)
      setUrl(undefined)
    }
  }, [blob])
  return url
}

function choosePng(take: (file: File) => void): void {
  const input = Object.assign(document.createElement('input'), { type: 'file', accept: 'image/png' })
  input.addEventListener('change', () => input.files?.[0] && take(input.files[0]))
  input.click()
}
