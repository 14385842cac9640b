import type { Limits, Settings } from '../state'
import { DEFAULT_SETTINGS } from '../state'
import type { Studio } from '../studio/studio'
import { text } from '../text'
import { button, el } from './dom'
import { numberField, type Row, selectField } from './fields'
import { anotherButton } from './growButtons'
import { makePanel } from './panel'
import type { Span } from './spans'

type Value = string | number
/** What the service says of a setting: a span of numbers, or names. */
type Allowed = Partial<Span> & { readonly default: Value; readonly meaning: string; readonly names?: readonly string[] }

const SEED: Span = { min: 0, max: Number.MAX_SAFE_INTEGER, whole: true }

/** Make the panel with every setting that the service takes, and the seed. */
export function settingsPanel(studio: Studio): HTMLElement {
  const { store } = studio
  const rows = el('div', { class: 'settings' })
  const reset = button(
    { class: 'button outlined' },
    () => store.set({ settings: defaultsOf(store.state.limits) }),
    text.settings.reset,
  )
  const panel = makePanel('settings', text.settings.title, rows, el('footer', { class: 'settings-foot' }, reset))
  let fields: Row[] = []
  store.watch(
    state => state.limits,
    limits => {
      fields = limits ? fieldsOf(studio, limits) : []
      rows.replaceChildren(...fields.map(field => field.element), ...(limits ? [seedRow(studio)] : []))
    },
  )
  panel.addEventListener('toggle', () => {
    for (const field of fields) field.show()
  })
  return panel
}

/** Give what the service takes where nothing is chosen. */
export function defaultsOf(limits: Limits | null): Settings {
  const known = Object.entries((limits?.settings ?? {}) as Record<string, Allowed>)
  return { ...DEFAULT_SETTINGS, ...Object.fromEntries(known.map(([name, { default: value }]) => [name, value])) }
}

function fieldsOf(studio: Studio, limits: Limits): Row[] {
  return Object.entries(limits.settings as Record<string, Allowed>).map(([name, allowed]) =>
    fieldOf(studio, name, allowed),
  )
}

function fieldOf({ store }: Studio, name: string, allowed: Allowed): Row {
  const chosen = () => (store.state.settings as Readonly<Record<string, Value>>)[name] ?? allowed.default
  const choose = (value: Value) => store.set({ settings: { ...store.state.settings, [name]: value } })
  const words = { name, ...wordsOf(name, allowed) }
  const { min, max, whole, names } = allowed
  const row = names
    ? selectField(
        { ...words, choices: names.map(key => [key, words.names?.[key] ?? key]) },
        () => String(chosen()),
        choose,
      )
    : numberField(
        { ...words, span: { min: min ?? 0, max: max ?? 1, whole: whole ?? false } },
        () => Number(chosen()),
        choose,
      )
  store.watch(state => state.settings, row.show)
  return row
}

function wordsOf(name: string, { meaning }: Allowed) {
  const label = name.charAt(0).toUpperCase() + name.slice(1).replaceAll('_', ' ')
  return text.settings.known[name] ?? { label, why: meaning }
}

function seedRow(studio: Studio): HTMLElement {
  const { store } = studio
  const words = { name: 'seed', label: text.settings.seed, why: text.settings.seedWhy, span: SEED, slides: false }
  const row = numberField(
    words,
    () => store.state.seed,
    seed => store.set({ seed }),
  )
  store.watch(state => state.seed, row.show)
  row.element.querySelector('.setting-entry')!.append(anotherButton(studio))
  return row.element
}
