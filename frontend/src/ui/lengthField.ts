import { labelPlace } from '../sketch/lengthLabel'
import { type View, within } from '../sketch/viewport'
import type { State } from '../state'
import type { Line, Scale } from '../strokes'
import type { Studio } from '../studio/studio'
import { text } from '../text'
import { button, el, icon } from './dom'
import { ICONS } from './icons'
import { numberIn } from './parts/spans'
import './lengthField.css'

/** Beside a line; `look` keeps it there when the photo is moved. */
export interface LengthField {
  readonly element: HTMLElement
  look(view: View): void
}

/** Metres that a line may be said to have; what makes no tree of it is for the service to refuse. */
const SPAN = { min: 0.001, max: 1000, whole: false }
/** The field stays as far inside the window, CSS px. */
const MARGIN = 6

/** Make the field for the length of the measured line, at the line while it is selected; `canvas` gets the focus back. */
export function lengthField({ store, sketchbook }: Studio, canvas: () => HTMLElement | null): LengthField {
  const field = el('input', {
    type: 'text',
    inputmode: 'decimal',
    'aria-label': text.length.field,
    autocomplete: 'off',
  })
  const wrong = el('p', { class: 'length-wrong', role: 'alert' })
  const remove = button(
    { class: 'button square', 'aria-label': text.length.delete, title: text.length.delete },
    () => sketchbook.remove(),
    icon(ICONS.remove),
  )
  const unit = el('span', { 'aria-hidden': 'true' }, text.length.unit)
  const element = el('div', { class: 'length-field', hidden: true }, el('div', {}, field, unit, remove), wrong)
  let view: View | null = null
  const place = () => {
    const { scale } = store.strokes
    if (scale && view && !element.hidden) placeAt(element, scale, view)
  }
  const say = (fault: string) => {
    wrong.textContent = fault
    field.setAttribute('aria-invalid', String(fault !== ''))
  }
  const commit = () => {
    const metres = numberIn(field.value.replace(',', '.'), SPAN)
    say(metres === null ? text.length.wrong : '')
    if (metres !== null) sketchbook.measure(metres)
    return metres !== null
  }
  field.addEventListener('change', commit)
  field.addEventListener('keydown', event => {
    if (event.key !== 'Enter' && event.key !== 'Escape') return
    event.preventDefault()
    if (event.key === 'Enter' && !commit()) return
    sketchbook.select(null)
    canvas()?.focus({ preventScroll: true })
  })
  let asked: Line | null = null
  store.watch(selected, scale => {
    element.hidden = scale === null
    if (!scale) return
    field.value = String(scale.metres)
    say('')
    place()
    if (asked !== scale.points && isLatest(store.state)) {
      field.focus({ preventScroll: true })
      field.select()
    }
    asked = scale.points
  })
  return {
    element,
    look: now => {
      view = now
      place()
    },
  }
}

function selected({ selection, history }: State): Scale | null {
  return selection?.kind === 'scale' ? history.present.scale : null
}

/** Whether the measured line is what was drawn last, so that its length is what comes next. */
function isLatest({ history }: State): boolean {
  const before = history.past.at(-1)
  return before !== undefined && before.scale?.points !== history.present.scale?.points
}

function placeAt(element: HTMLElement, { points }: Scale, view: View): void {
  const room = element.parentElement
  if (!room) return
  const { offsetWidth: width, offsetHeight: height } = element
  const [x, y] = labelPlace(points, view, { width, height })
  const inside = (middle: number, size: number, most: number) =>
    within(middle - size / 2, MARGIN, Math.max(MARGIN, most - size - MARGIN))
  element.style.left = `${inside(x, width, room.clientWidth)}px`
  element.style.top = `${inside(y, height, room.clientHeight)}px`
}
