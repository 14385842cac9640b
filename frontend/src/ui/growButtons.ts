import type { State } from '../state'
import type { Studio } from '../studio/studio'
import { text } from '../text'
import { button, icon } from './dom'
import { ICONS } from './icons'
import { canGrow, isBusy, standingOf } from './standing'

/** Make the button that grows the tree; what `describes` it says why it cannot where it cannot. */
export function growButton(studio: Studio, describes: string): HTMLButtonElement {
  const made = growing(studio, { class: 'button chief grow', 'aria-describedby': describes }, () =>
    studio.grower.grow(),
  )
  studio.store.watch(labelOf, label => made.replaceChildren(label))
  return made
}

function labelOf(state: State): string {
  if (isBusy(standingOf(state))) return text.grow.growing
  return state.model && state.modelOf ? text.grow.again : text.grow.grow
}

/** Make the button that grows another tree of the same strokes. */
export function anotherButton(studio: Studio): HTMLButtonElement {
  const made = growing(studio, { class: 'button outlined another', title: text.grow.anotherWhy }, () =>
    studio.grower.reroll(),
  )
  made.append(icon(ICONS.dice), text.grow.another)
  return made
}

/** Make a button that asks for a tree; where it would do nothing it says so, and keeps the focus all the same. */
function growing({ store }: Studio, attributes: Record<string, string>, ask: () => Promise<void>): HTMLButtonElement {
  const made = button(attributes, () => {
    if (canGrow(standingOf(store.state))) void ask()
  })
  store.watch(
    state => canGrow(standingOf(state)),
    can => made.setAttribute('aria-disabled', String(!can)),
  )
  return made
}
