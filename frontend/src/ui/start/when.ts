import { text } from '../../text'
import { LANGUAGE } from '../../text/numbers'

const STEPS = [
  ['minute', 60],
  ['hour', 3600],
  ['day', 86400],
  ['week', 604800],
] as const
const FAR_S = 4 * 604800

/** Say how long ago something was, or on which day if that is long ago; milliseconds since 1970. */
export function ago(then: number, now = Date.now()): string {
  const seconds = (now - then) / 1000
  const step = STEPS.findLast(([, length]) => seconds >= length)
  if (!step) return text.gallery.justNow
  if (seconds > FAR_S) return new Intl.DateTimeFormat(LANGUAGE, { dateStyle: 'medium' }).format(then)
  const [unit, length] = step
  return new Intl.RelativeTimeFormat(LANGUAGE, { numeric: 'auto' }).format(-Math.floor(seconds / length), unit)
}
