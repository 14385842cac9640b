import { text } from '../text'
import { el } from './dom'
import { numberAt, numberIn, placeOf, type Span } from './parts/spans'

/** A labelled setting; `show` brings it back to what is chosen. */
export interface Row {
  readonly element: HTMLElement
  show(): void
}

/** What is said of a setting. */
export interface Words {
  readonly name: string
  readonly label: string
  readonly why: string
  readonly unit?: string
}

const PLACES = 1000

/** Make a field for a number, with a slider unless it `slides` not; what is not taken is said there and not chosen. */
export function numberField(
  { span, slides = true, ...words }: Words & { readonly span: Span; readonly slides?: boolean },
  chosen: () => number,
  choose: (number: number) => void,
): Row {
  const { element, entry, describe, wrong } = frame(words)
  const field = el('input', {
    ...describe,
    type: 'number',
    step: 'any',
    min: span.min,
    max: span.max,
    inputmode: 'decimal',
  })
  // The slider says nothing that the field does not; it is for the pointer alone.
  const slider = el('input', { type: 'range', min: 0, max: PLACES, tabindex: -1, 'aria-hidden': 'true' })
  const say = (fault: string) => {
    wrong.textContent = fault
    field.setAttribute('aria-invalid', String(fault !== ''))
  }
  const slide = () => {
    slider.value = String(Math.round(placeOf(chosen(), span) * PLACES))
  }
  const show = () => {
    if (numberIn(field.value, span) !== chosen()) field.value = String(chosen())
    slide()
    say('')
  }
  field.addEventListener('input', () => {
    const number = numberIn(field.value, span)
    if (number === null) return
    say('')
    choose(number)
  })
  // Only when the number is written to its end: half of one is no fault.
  field.addEventListener('change', () => {
    if (numberIn(field.value, span) === null) say(text.settings.range(String(span.min), String(span.max), span.whole))
  })
  slider.addEventListener('input', () => choose(numberAt(Number(slider.value) / PLACES, span)))
  entry.append(
    ...(slides ? [slider] : []),
    field,
    ...(words.unit ? [el('span', { class: 'setting-unit' }, words.unit)] : []),
  )
  return { element, show }
}

/** Make a field for one of a few names, each with how it is spoken of. */
export function selectField(
  { choices, ...words }: Words & { readonly choices: readonly (readonly [name: string, spoken: string])[] },
  chosen: () => string,
  choose: (name: string) => void,
): Row {
  const { element, entry, describe } = frame(words)
  const field = el('select', describe, ...choices.map(([value, spoken]) => el('option', { value }, spoken)))
  field.addEventListener('change', () => choose(field.value))
  entry.append(field)
  return {
    element,
    show: () => {
      field.value = chosen()
    },
  }
}

function frame({ name, label, why }: Words) {
  const id = `setting-${name}`
  const wrong = el('p', { class: 'setting-wrong', id: `${id}-wrong`, role: 'alert' })
  const entry = el('div', { class: 'setting-entry' })
  const about = el('p', { class: 'setting-why', id: `${id}-why` }, why)
  const element = el('div', { class: 'setting' }, el('label', { for: id }, label), entry, about, wrong)
  return { element, entry, wrong, describe: { id, 'aria-describedby': `${id}-why ${id}-wrong` } }
}
