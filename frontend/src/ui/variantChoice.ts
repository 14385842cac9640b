import type { State } from '../state'
import type { Studio } from '../studio/studio'
import { variantsOf } from '../studio/variants'
import { text } from '../text'
import { button, el } from './dom'

/** More trees than these are chosen from a list. */
const MOST_BUTTONS = 6

/** Make the choice between the trees of a model; there is none where it has only one. */
export function variantChoice({ store, grower }: Studio): HTMLElement {
  const { variants: words } = text.preview
  const buttons = el('div', { class: 'variant-buttons', role: 'group', 'aria-label': words.group })
  const list = el('select', { class: 'variant-list', 'aria-label': words.group })
  list.addEventListener('change', () => void grower.choose(Number(list.value)))
  const choice = el('div', { class: 'afloat variants', hidden: true }, buttons, list)
  const mark = () => {
    const { variant } = store.state
    for (const one of buttons.children) one.setAttribute('aria-pressed', String(one.textContent === String(variant)))
    list.value = String(variant)
  }
  store.watch(countOf, count => {
    choice.hidden = count < 2
    choice.classList.toggle('many', count > MOST_BUTTONS)
    const numbers = Array.from({ length: count }, (_, at) => at + 1)
    buttons.replaceChildren(...numbers.map(number => numberButton(number, count)))
    list.replaceChildren(...numbers.map(number => el('option', { value: number }, words.oneOf(number, count))))
    mark()
  })
  store.watch(state => state.variant, mark)
  return choice

  function numberButton(number: number, count: number): HTMLElement {
    const label = words.oneOf(number, count)
    return button(
      { class: 'button square', 'aria-label': label, title: label },
      () => void grower.choose(number),
      String(number),
    )
  }
}

function countOf({ model, tree }: State): number {
  return model && tree ? variantsOf(model) : 0
}
