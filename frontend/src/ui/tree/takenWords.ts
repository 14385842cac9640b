import type { Limits } from '../../api/types'
import type { State } from '../../state'
import { AUTO, shownTaken, type Trait, takenIn, traitOf } from '../../taken'
import { text } from '../../text'
import { type Allowed, readable } from './settingGroups'

/** Least sureness that is called very sure; between it and where the page asks, the kind is likely. */
const SURE = 0.9

/** Return what a trait of the shown tree is; empty while it is not known. */
export function nameOf(state: State, trait: Trait): string {
  const shown = traitOf(state, trait)
  return shown ? shortName(shown.from === 'species' ? 'species' : trait, shown.name) : ''
}

/** Return what stands before the name of a trait. */
export function leadOf(state: State, trait: Trait): string {
  return text.taken.leads[trait === 'form' ? 'form' : (traitOf(state, trait)?.from ?? 'photo')]
}

/** Return how sure the kind is that the photo shows; null where it was chosen. */
export function surenessOf(state: State): keyof typeof text.taken.sureness | null {
  const taken = shownTaken(state)
  if (!taken || traitOf(state, 'foliage')?.from !== 'photo') return null
  if (taken.ask) return 'unsure'
  return taken.sureness >= SURE ? 'sure' : 'likely'
}

/** Return the names that a trait may have, as the service lists them, with their words. */
export function namesOf(limits: Limits | null, trait: Trait): (readonly [name: string, words: string])[] {
  const { names = [] } = (limits?.settings[trait] ?? {}) as Partial<Allowed>
  return names.filter(name => name !== AUTO).map(name => [name, fullName(trait, name)])
}

/** Return how the choice is worded that leaves a trait to the photo, or to the species. */
export function autoWords(state: State, trait: Trait): string {
  const { species } = state.settings
  if (trait === 'foliage' && species !== AUTO) return text.taken.asSpecies(shortName('species', species))
  const taken = takenIn(state)
  const { auto } = text.settings.known[trait]!.names!
  return taken ? text.taken.asInPhoto(shortName(trait, taken[trait])) : auto!
}

/** Return the name of a choice as the settings have it. */
export function fullName(setting: string, name: string): string {
  return text.settings.known[setting]?.names?.[name] ?? readable(name)
}

/** Return the name of a choice without what explains it, to stand within a sentence. */
export function shortName(setting: string, name: string): string {
  return fullName(setting, name)
    .replace(/ \(.*\)$/, '')
    .toLowerCase()
}
