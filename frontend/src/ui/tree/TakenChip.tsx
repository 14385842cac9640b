import type { ComponentChildren } from 'preact'
import { useLayoutEffect, useRef } from 'preact/hooks'
import { AUTO, asksForKind, type Trait, takenIn, traitOf } from '../../taken'
import { text } from '../../text'
import { Icon } from '../parts/Icon'
import { ICONS } from '../parts/icons'
import { Popover } from '../parts/Popover'
import { RadioButtons } from '../parts/RadioButtons'
import { useStore, useStudio } from '../parts/useStore'
import { autoWords, fullName, leadOf, nameOf, namesOf, shortName, surenessOf } from './takenWords'
import './takenChip.css'

/** What the photo's tree is taken for, and how to say otherwise; a question where the photo leaves it open. */
export function TakenChip() {
  const { store } = useStudio()
  const isKnown = useStore(state => traitOf(state, 'foliage') !== null)
  const asks = useStore(asksForKind)
  const chip = useRef<HTMLDivElement>(null)
  // Found before question and chip take each other's place, which loses the focus.
  const hadFocus = chip.current?.contains(document.activeElement) ?? false
  useLayoutEffect(() => {
    if (asks) store.announce(text.taken.question)
    if (hadFocus) chip.current!.querySelector<HTMLElement>('button:not([tabindex="-1"])')?.focus()
  }, [asks])
  return (
    <div class="overlay taken" role="group" aria-label={text.taken.label} ref={chip} hidden={!isKnown}>
      {asks ? <Question /> : <Traits />}
    </div>
  )
}

function Traits() {
  const sureness = useStore(surenessOf)
  return (
    <>
      <TraitMenu trait="foliage">
        {sureness && <span class={`taken-note is-${sureness}`}>{text.taken.sureness[sureness]}</span>}
      </TraitMenu>
      <TraitMenu trait="form" />
    </>
  )
}

interface TraitProps {
  readonly trait: Trait
  /** What else is said of it. */
  readonly children?: ComponentChildren
}

/** A button that says what a trait is, and opens its choices. */
function TraitMenu({ trait, children }: TraitProps) {
  const lead = useStore(state => leadOf(state, trait))
  const name = useStore(state => nameOf(state, trait))
  const auto = useStore(state => autoWords(state, trait))
  const chosen = useStore(state => state.settings[trait])
  const limits = useStore(state => state.limits)
  const panel = useRef<HTMLDivElement>(null)
  const take = useTake(trait)
  const choose = (choice: string) => {
    panel.current!.hidePopover()
    take(choice)
  }
  const label = text.taken.menus[trait]
  const says = (
    <>
      {trait === 'foliage' && <Icon path={ICONS.leaf} />}
      <span>
        <span class="taken-lead">{lead}</span>
        <span class="taken-name">{name}</span>
      </span>
      {children}
      <Icon path={ICONS.down} />
    </>
  )
  return (
    <Popover
      opener={{ class: 'button', title: label, children: says }}
      class="taken-menu"
      label={label}
      panelRef={panel}
    >
      <RadioButtons label={label} choices={[[AUTO, auto], ...namesOf(limits, trait)]} chosen={chosen} choose={choose} />
    </Popover>
  )
}

/** The question what kind of tree it is, with the kind that it is taken for until it is answered. */
function Question() {
  const kind = useStore(state => takenIn(state)?.foliage ?? '')
  const limits = useStore(state => state.limits)
  const { question, questionWhy } = text.taken
  return (
    <div class="taken-question">
      <p>
        <strong>{question}</strong> <span class="taken-note">{questionWhy(shortName('foliage', kind))}</span>
      </p>
      <RadioButtons label={question} choices={namesOf(limits, 'foliage')} chosen={kind} choose={useTake('foliage')} />
    </div>
  )
}

/** Return how a trait is set; screen readers say what was chosen. */
function useTake(trait: Trait): (name: string) => void {
  const { store, taken } = useStudio()
  return name => {
    const words = name === AUTO ? autoWords(store.state, trait) : fullName(trait, name)
    if (taken.take(trait, name)) store.announce(text.taken.changed(words))
  }
}
