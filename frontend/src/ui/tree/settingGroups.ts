import { DEFAULT_SETTINGS } from '../../api/defaults'
import type { Limits, Settings } from '../../api/types'
import { text } from '../../text'
import type { Span } from '../parts/spans'

export type Value = string | number | boolean | readonly string[]
/** What the service says of a setting: a range of numbers, one or several names, or yes and no. */
export type Allowed = Partial<Span> & {
  readonly default: Value
  readonly meaning: string
  readonly group?: string
  readonly names?: readonly string[]
  readonly several?: boolean
  readonly toggle?: boolean
}

/** Settings that belong together, in the service's order. */
export interface Group {
  readonly name: string
  readonly label: string
  readonly settings: readonly (readonly [name: string, allowed: Allowed])[]
}

/** Group the settings that the service takes; one without a group belongs to the first. */
export function groupsOf(limits: Limits): Group[] {
  const all = settingsOf(limits)
  const names = [...new Set(all.map(([, { group }]) => group ?? FIRST_GROUP))]
  return names.map(name => ({
    name,
    label: text.settings.groups[name] ?? readable(name),
    settings: all.filter(([, { group }]) => (group ?? FIRST_GROUP) === name),
  }))
}

/** Return the settings that the service takes where nothing is chosen. */
export function defaultsOf(limits: Limits | null): Settings {
  const known = limits ? settingsOf(limits) : []
  return { ...DEFAULT_SETTINGS, ...Object.fromEntries(known.map(([name, { default: value }]) => [name, value])) }
}

/** Whether a setting only says what files are made of a tree. */
export function isOfFile(limits: Limits | null, name: string): boolean {
  return (limits?.settings as Record<string, Allowed> | undefined)?.[name]?.group === 'file'
}

/** Whether two values of a setting are the same; of several names the order does not matter. */
export function sameValue(one: unknown, other: unknown): boolean {
  if (!Array.isArray(one) || !Array.isArray(other)) return one === other
  return one.length === other.length && one.every(name => other.includes(name))
}

/** Write one of the service's names as words, for where the page has none of its own. */
export function readable(name: string): string {
  return name.charAt(0).toUpperCase() + name.slice(1).replaceAll('_', ' ')
}

export const FIRST_GROUP = 'tree'

function settingsOf(limits: Limits): [string, Allowed][] {
  return Object.entries(limits.settings as Record<string, Allowed>)
}
