/** The page's language, which numbers and plurals follow. */
export const LANGUAGE = 'en'

const wholes = new Intl.NumberFormat(LANGUAGE, { maximumFractionDigits: 0 })
const hundredths = new Intl.NumberFormat(LANGUAGE, { minimumFractionDigits: 2, maximumFractionDigits: 2 })
const rounded = new Intl.NumberFormat(LANGUAGE, { minimumSignificantDigits: 2, maximumSignificantDigits: 3 })
const written = new Intl.NumberFormat(LANGUAGE, { useGrouping: false, maximumSignificantDigits: 17 })
const shares = new Intl.NumberFormat(LANGUAGE, { style: 'percent', maximumFractionDigits: 0 })
const [wholeSeconds, tenthSeconds] = [inUnits('second', 0), inUnits('second', 1)]
const [minutes, hours] = [inUnits('minute', 0), inUnits('hour', 0)]
const lengths = new Intl.NumberFormat(LANGUAGE, { style: 'unit', unit: 'meter', maximumSignificantDigits: 3 })
const [kilobytes, megabytes, gigabytes] = [inUnits('kilobyte', 0), inUnits('megabyte', 1), inUnits('gigabyte', 1)]

/** Write a whole number. */
export function whole(number: number): string {
  return wholes.format(number)
}

/** Write a number with two digits after the point. */
export function hundredth(number: number): string {
  return hundredths.format(number)
}

/** Write a measured number with two or three digits that count; larger ones as whole numbers. */
export function measured(number: number): string {
  return number >= 100 ? wholes.format(number) : rounded.format(number)
}

/** Write a number as it can be typed into a field. */
export function typed(number: number): string {
  return written.format(number)
}

/** Write a share, 0 to 1, as per cent. */
export function percent(share: number): string {
  return shares.format(share)
}

/** Write a duration that is left: whole seconds, minutes or hours. */
export function duration(seconds: number): string {
  if (seconds < 90) return wholeSeconds.format(seconds)
  return seconds < 90 * 60 ? minutes.format(seconds / 60) : hours.format(seconds / 3600)
}

/** Write a duration that was measured, in tenths of a second. */
export function seconds(number: number): string {
  return tenthSeconds.format(number)
}

/** Write a length in metres, with three digits that count. */
export function metres(number: number): string {
  return lengths.format(number)
}

/** Write a number of bytes. */
export function bytes(number: number): string {
  if (number < 1e6) return kilobytes.format(number / 1e3)
  return number < 1e9 ? megabytes.format(number / 1e6) : gigabytes.format(number / 1e9)
}

function inUnits(unit: string, maximumFractionDigits: number): Intl.NumberFormat {
  return new Intl.NumberFormat(LANGUAGE, { style: 'unit', unit, unitDisplay: 'short', maximumFractionDigits })
}
