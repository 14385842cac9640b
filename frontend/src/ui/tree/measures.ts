import type { Model } from '../../api/types'
import { text } from '../../text'
import { measured, whole } from '../../text/numbers'
import { readable } from './settingGroups'

/** A measure of the tree, as people write it. */
export interface Measure {
  readonly name: string
  readonly label: string
  readonly value: string
  /** Where the value may lie; empty where nothing is said of it. */
  readonly range: string
  /** How sure it is: a word, and what that means. */
  readonly basis: readonly [word: string, meaning: string] | null
  readonly why: string
}

/** What the service says of a measure. */
interface Reported {
  readonly value?: number | readonly number[] | null
  readonly unit?: string
  readonly low?: number | null
  readonly high?: number | null
  readonly basis?: string
  readonly meaning?: string
}

const { measures: words } = text.score

/** List a model's measures in the service's order; empty where it gives none. */
export function measuresOf({ report }: Model): Measure[] {
  const reported = (report?.measures ?? {}) as Readonly<Record<string, Reported>>
  return Object.entries(reported).map(([name, measure]) => measureOf(name, measure))
}

function measureOf(name: string, { value, unit = '', low, high, basis, meaning }: Reported): Measure {
  const [label, why] = words.known[name] ?? [readable(name), meaning ?? '']
  return { name, label, value: valueAs(name, value, unit), range: rangeOf(low, high, unit), basis: basisOf(basis), why }
}

function valueAs(name: string, value: Reported['value'], unit: string): string {
  if (value === null || value === undefined) return words.unknown
  if (typeof value !== 'number') return value.map(count => whole(count)).join(' · ')
  if (!unit) return whole(value)
  return name === 'scale' ? words.perPixel(quantity(value, 'm')) : quantity(value, unit)
}

function rangeOf(low: Reported['low'], high: Reported['high'], unit: string): string {
  if (typeof low !== 'number' || typeof high !== 'number' || low === high) return ''
  // Both in the one unit, that of the larger.
  const small = unit === 'm' && high < 1
  const write = (number: number) => measured(small ? number * 100 : number)
  return words.range(write(low), write(high), small ? 'cm' : unit)
}

function basisOf(basis: string | undefined): Measure['basis'] {
  return basis === undefined ? null : (words.basis[basis] ?? [basis, ''])
}

/** Write a number with its unit; lengths below a metre in centimetres. */
function quantity(value: number, unit: string): string {
  const small = unit === 'm' && Math.abs(value) < 1
  return words.quantity(measured(small ? value * 100 : value), small ? 'cm' : unit)
}
