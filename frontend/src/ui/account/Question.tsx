import { useLayoutEffect, useRef } from 'preact/hooks'

interface Props {
  readonly question: string
  readonly yes: string
  readonly no: string
  answer(yes: boolean): void
}

/** A question in the place of what it is about; what changes nothing has the focus, and Escape chooses it. */
export function Question({ question, yes, no, answer }: Props) {
  const quiet = useRef<HTMLButtonElement>(null)
  useLayoutEffect(() => quiet.current!.focus(), [])
  const press = (event: KeyboardEvent) => {
    if (event.key !== 'Escape') return
    event.preventDefault() // it would close the dialog
    answer(false)
  }
  return (
    <div class="question" role="group" aria-label={question} onKeyDown={press}>
      <p>{question}</p>
      <div class="question-answers">
        <button type="button" class="button outlined is-grave" onClick={() => answer(true)}>
          {yes}
        </button>
        <button type="button" class="button outlined" ref={quiet} onClick={() => answer(false)}>
          {no}
        </button>
      </div>
    </div>
  )
}
