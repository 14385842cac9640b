import type { TargetedKeyboardEvent } from 'preact'
import { placeAfter } from './placeAfter'
import './radioButtons.css'

interface Props {
  readonly label: string
  /** The names, and how they are written. */
  readonly choices: readonly (readonly [name: string, words: string])[]
  readonly chosen: string
  choose(name: string): void
}

/** The keys of a column lead where those of a row do. */
const ROW_KEYS: Readonly<Record<string, string>> = { ArrowUp: 'ArrowLeft', ArrowDown: 'ArrowRight' }

/** Buttons for one of several names; arrow keys go from one to the next, and only Enter, Space or a click chooses. */
export function RadioButtons({ label, choices, chosen, choose }: Props) {
  const chosenAt = Math.max(
    choices.findIndex(([name]) => name === chosen),
    0,
  )
  const step = (event: TargetedKeyboardEvent<HTMLElement>) => {
    const buttons = [...event.currentTarget.children] as HTMLElement[]
    const at = buttons.indexOf(document.activeElement as HTMLElement)
    const next = placeAfter(ROW_KEYS[event.key] ?? event.key, at, buttons.length)
    if (next === undefined) return
    event.preventDefault() // the page does not scroll
    buttons[next]!.focus()
  }
  return (
    <div class="radio-buttons" role="radiogroup" aria-label={label} onKeyDown={step}>
      {choices.map(([name, words], at) => (
        <button
          type="button"
          class="button"
          role="radio"
          key={name}
          aria-checked={name === chosen}
          tabIndex={at === chosenAt ? 0 : -1}
          onClick={() => choose(name)}
        >
          {words}
        </button>
      ))}
    </div>
  )
}
