import { DEFAULT_SETTINGS } from './api/defaults'
import type { Settings, Taken } from './api/types'
import type { State } from './state'

/** What a photo's tree is taken for, unless the setting of the same name says otherwise. */
export type Trait = 'foliage' | 'form'

/** The value of a setting that leaves a trait to the photo. */
export const AUTO = 'auto'

/** A trait's name, and where it comes from. */
export interface ShownTrait {
  readonly name: string
  readonly from: 'photo' | 'species' | 'settings'
}

type Trees = Pick<State, 'shows' | 'liveTree' | 'model' | 'settings' | 'traced'>

/** Return what the photo's tree is taken for; null while that is not known, and where the tree is sketched. */
export function takenIn({ traced, model }: Pick<State, 'traced' | 'model'>): Taken | null {
  return traced ? traced.answer.taken : (model?.info.taken ?? null)
}

/** Return what the tree that is shown, live or grown, was taken for by its photo and strokes. */
export function shownTaken(state: Trees): Taken | null {
  const { model, traced } = state
  const isOfOtherStrokes = showsModel(state) && model!.strokes !== traced?.of
  return (isOfOtherStrokes && model!.info.taken) || takenIn(state)
}

/** Return a trait of the tree that is shown; null while it is not known. */
export function traitOf(state: Trees, trait: Trait): ShownTrait | null {
  const taken = shownTaken(state)
  const settings = shownSettings(state)
  if (!taken) return null
  if (settings[trait] !== AUTO) return { name: settings[trait], from: 'settings' }
  if (trait === 'foliage' && settings.species !== AUTO) return { name: settings.species, from: 'species' }
  return { name: taken[trait], from: 'photo' }
}

/** Whether to ask what kind of tree it is: the photo leaves it open, and nobody has said it or grown the tree yet. */
export function asksForKind(state: Pick<State, 'settings' | 'model' | 'asking' | 'traced'>): boolean {
  const { settings, model, asking } = state
  const isChosen = settings.foliage !== AUTO || settings.species !== AUTO
  return !isChosen && !model && !asking && takenIn(state)?.ask === true
}

/** Return the settings by which the tree that is shown was grown. */
export function shownSettings(state: Omit<Trees, 'traced'>): Settings {
  return showsModel(state) ? { ...DEFAULT_SETTINGS, ...state.model!.info.settings } : state.settings
}

/** Whether the tree that is shown is a model's, and not the live one. */
export function showsModel({ shows, liveTree, model }: Pick<State, 'shows' | 'liveTree' | 'model'>): boolean {
  const hasTree = Boolean(model?.glb ?? model?.growth)
  return hasTree && (shows === 'model' || !liveTree)
}
