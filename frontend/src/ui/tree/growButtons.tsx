import type { ComponentChildren, RefObject } from 'preact'
import type { State } from '../../state'
import { text } from '../../text'
import { Icon } from '../parts/Icon'
import { ICONS } from '../parts/icons'
import { useStore, useStudio } from '../parts/useStore'
import { canGrow, growthStatusOf, isBusy } from './growthStatus'

interface GrowProps {
  /** The id of what says why it cannot grow where it cannot. */
  readonly describedBy: string
  readonly buttonRef: RefObject<HTMLButtonElement | null>
}

/** The button that grows the tree. */
export function GrowButton({ describedBy, buttonRef }: GrowProps) {
  const { grower } = useStudio()
  const label = useStore(labelOf)
  return (
    <GrowingButton
      class="button primary grow"
      aria-describedby={describedBy}
      buttonRef={buttonRef}
      ask={() => grower.grow()}
    >
      {label}
    </GrowingButton>
  )
}

/** The button that grows another tree of the same strokes. */
export function AnotherButton() {
  const { grower } = useStudio()
  return (
    <GrowingButton class="button outlined another" title={text.grow.anotherWhy} ask={() => grower.reroll()}>
      <Icon path={ICONS.dice} />
      {text.grow.another}
    </GrowingButton>
  )
}

interface GrowingProps {
  readonly class: string
  readonly title?: string
  readonly 'aria-describedby'?: string
  readonly buttonRef?: RefObject<HTMLButtonElement | null>
  readonly children: ComponentChildren
  ask(): Promise<void>
}

/** A button that asks for a tree; where it would do nothing it says so, and keeps the focus all the same. */
function GrowingButton({ ask, buttonRef, ...attributes }: GrowingProps) {
  const { store } = useStudio()
  const can = useStore(state => canGrow(growthStatusOf(state)))
  const click = () => {
    if (canGrow(growthStatusOf(store.state))) void ask()
  }
  return <button type="button" {...attributes} ref={buttonRef ?? null} aria-disabled={!can} onClick={click} />
}

function labelOf(state: State): string {
  if (isBusy(growthStatusOf(state))) return text.grow.growing
  return state.model ? text.grow.again : text.grow.grow
}
