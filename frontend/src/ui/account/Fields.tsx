import { useId } from 'preact/hooks'

const LONGEST_NAME = 100

interface ChoiceProps {
  readonly label: string
  readonly choices: readonly (readonly [name: string, words: string])[]
  readonly chosen: string
  choose(name: string): void
}

/** A labelled list of names of which one is chosen. */
export function Choice({ label, choices, chosen, choose }: ChoiceProps) {
  const id = useId()
  return (
    <div class="account-labelled">
      <label for={id}>{label}</label>
      <select id={id} class="account-field" value={chosen} onChange={event => choose(event.currentTarget.value)}>
        {choices.map(([name, words]) => (
          <option value={name} key={name}>
            {words}
          </option>
        ))}
      </select>
    </div>
  )
}

interface NameProps {
  readonly label: string
  readonly value: string
  readonly placeholder?: string
  write(value: string): void
}

/** A labelled line for a name, which may not be empty. */
export function NameField({ label, value, placeholder = '', write }: NameProps) {
  const id = useId()
  return (
    <div class="account-labelled">
      <label for={id}>{label}</label>
      <input
        id={id}
        class="account-field"
        autocomplete="off"
        placeholder={placeholder}
        maxLength={LONGEST_NAME}
        pattern=".*\S.*"
        required
        value={value}
        onInput={event => write(event.currentTarget.value)}
      />
    </div>
  )
}
