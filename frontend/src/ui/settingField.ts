import type { Settings } from '../api/types'
import type { Studio } from '../studio/studio'
import { text } from '../text'
import { severalField, toggleField } from './choiceFields'
import { numberField, type Row, selectField } from './fields'
import { type Allowed, spoken, type Value } from './settingGroups'

/** Make the field for one setting by what the service says of it. */
export function settingField({ store }: Studio, name: string, allowed: Allowed): Row {
  const chosen = () => (store.state.settings as Settings & Record<string, Value>)[name] ?? allowed.default
  const choose = (value: Value) => store.set({ settings: { ...store.state.settings, [name]: value } })
  const row = fieldFor(name, allowed, chosen, choose)
  store.watch(state => state.settings, row.show)
  return row
}

function fieldFor(name: string, allowed: Allowed, chosen: () => Value, choose: (value: Value) => void): Row {
  const words = { name, ...wordsOf(name, allowed) }
  const { min, max, whole, names, several, toggle } = allowed
  const choices = (names ?? []).map(key => [key, words.names?.[key] ?? spoken(key)] as const)
  if (toggle) return toggleField(words, () => chosen() === true, choose)
  if (several) return severalField({ ...words, choices }, () => chosen() as readonly string[], choose)
  if (names) return selectField({ ...words, choices }, () => String(chosen()), choose)
  const span = { min: min ?? 0, max: max ?? 1, whole: whole ?? false }
  return numberField({ ...words, span }, () => Number(chosen()), choose)
}

function wordsOf(name: string, { meaning }: Allowed) {
  return text.settings.known[name] ?? { label: spoken(name), why: meaning }
}
