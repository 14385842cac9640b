import { useEffect, useLayoutEffect, useRef, useState } from 'preact/hooks'
import { text } from '../../text'
import { Icon } from '../parts/Icon'
import { ICONS } from '../parts/icons'
import { copyText } from '../parts/saving'
import { useStudio } from '../parts/useStore'

const SHOWN_MS = 2500

/** The entry that copies a link to a model, or shows it where the browser does not let it be copied. */
export function CopyLink({ id }: { readonly id: string }) {
  const { store } = useStudio()
  const [isCopied, setCopied] = useState(false)
  const [refusals, setRefusals] = useState(0)
  const field = useRef<HTMLInputElement>(null)
  const link = `${location.origin}/#${id}`
  const [label, about] = text.files.link
  useEffect(() => {
    if (!isCopied) return
    const timer = setTimeout(() => setCopied(false), SHOWN_MS)
    return () => clearTimeout(timer)
  }, [isCopied])
  useLayoutEffect(() => {
    if (!refusals) return
    field.current?.focus()
    field.current?.select()
  }, [refusals])
  const copy = async () => {
    if (!(await copyText(link))) return setRefusals(count => count + 1)
    setRefusals(0)
    setCopied(true)
    store.announce(text.files.copied)
  }
  return (
    <div>
      <button type="button" class="download" onClick={() => void copy()}>
        <Icon path={ICONS.link} />
        <DownloadText label={isCopied ? text.files.copied : label} about={about} />
      </button>
      <div class="link-refused" hidden={refusals === 0}>
        <p>{text.files.copyYourself}</p>
        <input class="link-field" readOnly aria-label={text.files.copyYourself} value={link} ref={field} />
      </div>
    </div>
  )
}

/** A download's name and, below it, what it is. */
export function DownloadText({ label, about }: { readonly label: string; readonly about: string }) {
  return (
    <span class="download-text">
      <span class="download-label">{label}</span>
      <span class="download-about">{about}</span>
    </span>
  )
}
