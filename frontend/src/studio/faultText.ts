import { Refused, Unreachable } from '../api/request'
import type { Fault } from '../state'
import { type PhotoStrokes, strokeAt } from '../strokes'
import { text } from '../text'
import { duration } from '../text/numbers'

/** Codes of problems that say what a team has too much of, and not when that ends. */
const QUOTAS = ['quota_exceeded', 'queue_full']

/** A fault that the page itself finds; its message is a sentence for the user. */
export class PageFault extends Error {}

/** Return an error as a sentence for the user, perhaps about a stroke over one of many photos; any unexpected error is thrown again. */
export function faultOf(error: unknown, views: readonly PhotoStrokes[] = []): Fault {
  if (error instanceof Unreachable) return { text: text.faults.unreachable }
  if (error instanceof PageFault) return { text: error.message }
  if (!(error instanceof Refused)) throw error
  const stroke = strokeAt(error.pointer, views)
  const sentence = textFor(error.code) ?? sentenceOf(error.message)
  const later =
    error.retryAfter === null || !QUOTAS.includes(error.code)
      ? ''
      : ` ${text.access.tryAgain(duration(error.retryAfter))}`
  return { text: `${sentence}${later}`, ...(stroke && { stroke }) }
}

function textFor(code: string): string | undefined {
  return (text.faults.codes as Readonly<Record<string, string>>)[code]
}

/** Return the service's message as a sentence, without the place in the request that it begins with. */
export function sentenceOf(detail: string): string {
  const sentence = detail.replace(/^[\w/.-]+: /, '')
  return `${sentence.charAt(0).toUpperCase()}${sentence.slice(1)}${/[.!?]$/.test(sentence) ? '' : '.'}`
}
