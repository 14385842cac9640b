import { useLayoutEffect, useRef, useState } from 'preact/hooks'
import { accountText } from '../../text/account'
import { copyText } from '../parts/copying'

const { keys: words } = accountText

interface Props {
  readonly title: string
  /** Why it has to be copied now. */
  readonly lead: string
  readonly label: string
  readonly value: string
  done(): void
}

/** A secret that was just made: it is seen this once, to be copied. */
export function ShownOnce({ title, lead, label, value, done }: Props) {
  const [copied, setCopied] = useState<boolean | null>(null)
  const field = useRef<HTMLInputElement>(null)
  useLayoutEffect(() => field.current!.select(), [])
  const copy = async () => {
    setCopied(await copyText(value))
    field.current?.select()
  }
  return (
    <div class="new-key" role="group" aria-label={title}>
      <p class="new-key-title">{title}</p>
      <p>{lead}</p>
      <div class="new-key-line">
        <input class="account-field" aria-label={label} readOnly value={value} ref={field} />
        <button type="button" class="button primary" onClick={copy}>
          {copied ? words.copied : words.copy}
        </button>
        <button type="button" class="button outlined" onClick={done}>
          {words.done}
        </button>
      </div>
      <p role="status">{copied === false && words.copyYourself}</p>
    </div>
  )
}
