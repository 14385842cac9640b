import { el } from './dom'
import type { Row, Words } from './fields'

/** Make a field for yes and no. */
export function toggleField({ name, label, why }: Words, chosen: () => boolean, choose: (yes: boolean) => void): Row {
  const id = `setting-${name}`
  const box = el('input', { id, type: 'checkbox', 'aria-describedby': `${id}-why` })
  box.addEventListener('change', () => choose(box.checked))
  const line = el('label', { class: 'setting-check', for: id }, box, el('span', {}, label))
  const element = el('div', { class: 'setting' }, line, el('p', { class: 'setting-why', id: `${id}-why` }, why))
  return {
    element,
    show: () => {
      box.checked = chosen()
    },
  }
}

/** Make a list of names of which any may be chosen, none too. */
export function severalField(
  { name, label, why, choices }: Words & { readonly choices: readonly (readonly [name: string, spoken: string])[] },
  chosen: () => readonly string[],
  choose: (names: readonly string[]) => void,
): Row {
  const id = `setting-${name}`
  const boxes = choices.map(([value]) => el('input', { type: 'checkbox', value, id: `${id}-${value}` }))
  for (const box of boxes)
    box.addEventListener('change', () => choose(boxes.filter(one => one.checked).map(one => one.value)))
  const lines = boxes.map((box, at) =>
    el('label', { class: 'setting-check', for: box.id }, box, el('span', {}, choices[at]![1])),
  )
  const element = el(
    'fieldset',
    { class: 'setting', id, 'aria-describedby': `${id}-why` },
    el('legend', {}, label),
    el('p', { class: 'setting-why', id: `${id}-why` }, why),
    el('div', { class: 'setting-checks' }, ...lines),
  )
  return {
    element,
    show: () => {
      for (const box of boxes) box.checked = chosen().includes(box.value)
    },
  }
}
