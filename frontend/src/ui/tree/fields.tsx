import type { ComponentChildren } from 'preact'
import { useState } from 'preact/hooks'
import { text } from '../../text'
import { typed } from '../../text/numbers'
import { numberAt, numberIn, placeOf, type Span } from '../parts/spans'

/** What is said of a setting. */
export interface FieldText {
  readonly name: string
  readonly label: string
  readonly why: string
  readonly unit?: string
}

interface Frame extends FieldText {
  /** What is wrong with what was written. */
  readonly wrong?: string
  /** What else is to be known for now. */
  readonly note?: string | undefined
  readonly children: ComponentChildren
}

/** What is chosen now, and how to choose something else. */
interface Chosen<T> {
  readonly chosen: T
  choose(value: T): void
}

interface NumberProps extends FieldText, Chosen<number> {
  readonly span: Span
  /** As long as this is the same, a half-written number stays in the field. */
  readonly since: unknown
  readonly slides?: boolean
  readonly disabled?: boolean
  readonly note?: string | undefined
  /** What stands beside the field. */
  readonly children?: ComponentChildren
}

/** One of several names, and how it is written. */
export type Choice = readonly [name: string, label: string]

const PLACES = 1000

/** A field for a number, with a slider unless `slides` is false; it says what is wrong with a number it refuses. */
export function NumberField({ span, chosen, choose, since, slides = true, disabled = false, ...props }: NumberProps) {
  const { children, note, ...words } = props
  const [draft, setDraft] = useState({ written: '', since: {} as unknown, isDone: false })
  const number = numberIn(draft.written, span)
  const isCurrent = number === chosen || draft.since === since
  // Only when the number is written to its end: half of one is no fault.
  const isWrong = isCurrent && number === null && draft.isDone
  const write = (written: string, isDone: boolean) => {
    setDraft({ written, since, isDone })
    const next = numberIn(written, span)
    if (next !== null && next !== chosen) choose(next)
  }
  return (
    <FieldFrame {...words} note={note} wrong={isWrong ? rangeText(span) : ''}>
      {/* The slider says nothing that the field does not; it is for the pointer alone. */}
      {slides && (
        <input
          type="range"
          min={0}
          max={PLACES}
          tabIndex={-1}
          aria-hidden="true"
          disabled={disabled}
          value={Math.round(placeOf(chosen, span) * PLACES)}
          onInput={event => choose(numberAt(Number(event.currentTarget.value) / PLACES, span))}
        />
      )}
      <input
        {...described(words.name)}
        type="number"
        step="any"
        min={span.min}
        max={span.max}
        inputMode="decimal"
        aria-invalid={isWrong}
        disabled={disabled}
        value={isCurrent ? draft.written : String(chosen)}
        onInput={event => write(event.currentTarget.value, false)}
        onChange={event => write(event.currentTarget.value, true)}
      />
      {words.unit && <span class="setting-unit">{words.unit}</span>}
      {children}
    </FieldFrame>
  )
}

interface SelectProps extends FieldText, Chosen<string> {
  readonly choices: readonly Choice[]
}

/** A field for one of a few names. */
export function SelectField({ choices, chosen, choose, ...words }: SelectProps) {
  return (
    <FieldFrame {...words}>
      <select {...described(words.name)} value={chosen} onChange={event => choose(event.currentTarget.value)}>
        {choices.map(([name, label]) => (
          <option value={name} key={name}>
            {label}
          </option>
        ))}
      </select>
    </FieldFrame>
  )
}

/** A field for yes and no. */
export function ToggleField({ name, label, why, chosen, choose }: FieldText & Chosen<boolean>) {
  const id = idOf(name)
  return (
    <div class="setting">
      <label class="setting-check" for={id}>
        <input
          id={id}
          type="checkbox"
          aria-describedby={`${id}-why`}
          checked={chosen}
          onChange={event => choose(event.currentTarget.checked)}
        />
        <span>{label}</span>
      </label>
      <p class="setting-why" id={`${id}-why`}>
        {why}
      </p>
    </div>
  )
}

interface SeveralProps extends FieldText, Chosen<readonly string[]> {
  readonly choices: readonly Choice[]
}

/** A list of names of which any number may be chosen. */
export function SeveralField({ name, label, why, choices, chosen, choose }: SeveralProps) {
  const id = idOf(name)
  const turn = (value: string, on: boolean) =>
    choose(choices.map(([one]) => one).filter(one => (one === value ? on : chosen.includes(one))))
  return (
    <fieldset class="setting" id={id} aria-describedby={`${id}-why`}>
      <legend>{label}</legend>
      <p class="setting-why" id={`${id}-why`}>
        {why}
      </p>
      <div class="setting-checks">
        {choices.map(([value, words]) => (
          <label class="setting-check" for={`${id}-${value}`} key={value}>
            <input
              type="checkbox"
              id={`${id}-${value}`}
              value={value}
              checked={chosen.includes(value)}
              onChange={event => turn(value, event.currentTarget.checked)}
            />
            <span>{words}</span>
          </label>
        ))}
      </div>
    </fieldset>
  )
}

function FieldFrame({ name, label, why, wrong = '', note, children }: Frame) {
  const id = idOf(name)
  return (
    <div class="setting">
      <label for={id}>{label}</label>
      <div class="setting-entry">{children}</div>
      <p class="setting-why" id={`${id}-why`}>
        {why}
      </p>
      <p class="setting-wrong" id={`${id}-wrong`} role="alert">
        {wrong}
      </p>
      {note !== undefined && (
        <p class="setting-note" id={`${id}-note`}>
          {note}
        </p>
      )}
    </div>
  )
}

function described(name: string) {
  const id = idOf(name)
  return { id, 'aria-describedby': `${id}-why ${id}-wrong` }
}

function idOf(name: string): string {
  return `setting-${name}`
}

function rangeText({ min, max, whole }: Span): string {
  return text.settings[whole ? 'wholeRange' : 'range'](typed(min), typed(max))
}
