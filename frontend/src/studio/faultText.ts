import { Refused, Unreachable } from '../api/client'
import type { Fault } from '../state'
import { strokeAt } from '../strokes'
import { text } from '../text'

/** Says what is wrong and what to do; thrown where the page itself finds the fault. */
export class Unusable extends Error {}

/** Put an error into a sentence for the user; what is none of ours is thrown again. */
export function faultOf(error: unknown): Fault {
  if (error instanceof Unreachable) return { text: text.faults.unreachable }
  if (error instanceof Unusable) return { text: error.message }
  if (!(error instanceof Refused)) throw error
  const stroke = strokeAt(error.pointer)
  return { text: wording(error.code) ?? sentenceOf(error.message), ...(stroke && { stroke }) }
}

function wording(code: string): string | undefined {
  return (text.faults.codes as Readonly<Record<string, string>>)[code]
}

/** Write what the service says as a sentence, without where in the request the fault lies. */
export function sentenceOf(detail: string): string {
  const sentence = detail.replace(/^[\w/.-]+: /, '')
  return `${sentence.charAt(0).toUpperCase()}${sentence.slice(1)}${/[.!?]$/.test(sentence) ? '' : '.'}`
}
