import { useEffect, useId, useRef, useState } from 'preact/hooks'
import { copyText } from './copying'
import './copyField.css'

/** How long it is said that something was copied. */
const COPIED_MS = 2500

interface Props {
  readonly label: string
  readonly value: string
  /** What the button says, and what it says once it has copied. */
  readonly copy: string
  readonly copied: string
}

/** A text to be copied, by its button or, where the browser refuses that, by hand. */
export function CopyField({ label, value, copy, copied }: Props) {
  const [isCopied, setCopied] = useState(false)
  const field = useRef<HTMLInputElement>(null)
  const id = useId()
  useEffect(() => {
    if (!isCopied) return
    const timer = setTimeout(() => setCopied(false), COPIED_MS)
    return () => clearTimeout(timer)
  }, [isCopied])
  const take = async () => {
    field.current!.select()
    setCopied(await copyText(value))
  }
  return (
    <div class="copy-field">
      <label for={id}>{label}</label>
      <div class="copy-line">
        <input readOnly id={id} value={value} ref={field} onFocus={event => event.currentTarget.select()} />
        <button type="button" class="button outlined" onClick={() => void take()}>
          <span role="status">{isCopied ? copied : copy}</span>
        </button>
      </div>
    </div>
  )
}
