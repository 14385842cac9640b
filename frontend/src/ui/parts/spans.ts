/** The numbers that a setting takes, as the service says it. */
export interface Span {
  readonly min: number
  readonly max: number
  readonly whole: boolean
}

/** Read a number that a person wrote; null where the setting does not take it. */
export function numberIn(written: string, { min, max, whole }: Span): number | null {
  const number = written.trim() === '' ? Number.NaN : Number(written)
  const taken = number >= min && number <= max && (!whole || Number.isInteger(number))
  return taken ? number : null
}

/** Find where on a slider, 0 to 1, a number lies; what cannot be 0 goes by factors, so that its middle is easy to hit. */
export function placeOf(number: number, span: Span): number {
  const { min, max } = span
  return byFactors(span) ? Math.log(number / min) / Math.log(max / min) : (number - min) / (max - min)
}

/** Give the round number at a place on a slider, 0 to 1. */
export function numberAt(place: number, span: Span): number {
  const { min, max, whole } = span
  const exact = byFactors(span) ? min * (max / min) ** place : min + place * (max - min)
  const fine = 10 ** Math.floor(Math.log10(byFactors(span) ? exact / 5 : (max - min) / 60))
  const step = whole ? Math.max(1, fine) : fine
  const round = Number((Math.round(exact / step) * step).toPrecision(6))
  return Math.min(max, Math.max(min, round))
}

function byFactors({ min, whole }: Span): boolean {
  return min > 0 && !whole
}
