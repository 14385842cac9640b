import type { Delivery, Webhook } from '../../api/types'
import { LANGUAGE } from '../../text/numbers'
import { webhookText as words } from '../../text/webhooks'
import { ago } from '../start/when'

const seconds = new Intl.NumberFormat(LANGUAGE, { maximumFractionDigits: 1 })
const moment = new Intl.DateTimeFormat(LANGUAGE, { dateStyle: 'medium', timeStyle: 'short' })

/** Return what is to be known of a webhook, as short phrases. */
export function factsOf(webhook: Webhook, now = Date.now()): string[] {
  const state = webhook.enabled
    ? words.enabled
    : webhook.disabled_reason
      ? words.disabledBy[webhook.disabled_reason]
      : words.disabled
  const last = webhook.last_delivery
  return [state, ...(last ? [eventName(last), ...outcomeOf(last, now)] : [words.silent])]
}

/** Return what became of a message, as short phrases. */
export function outcomeOf(delivery: Delivery, now = Date.now()): string[] {
  const { state, status, error, last_attempt: last, next_attempt: next } = delivery
  const answer = status === null ? error : words.answered(status, seconds.format(delivery.seconds ?? 0))
  const isLater = state === 'waiting' && next !== null && answer !== null
  return [
    words.states[state],
    ...(answer === null ? [] : [answer]),
    ...(last === null ? [] : [ago(Date.parse(last), now)]),
    ...(isLater ? [words.again(moment.format(Date.parse(next)))] : []),
  ]
}

/** Return what a message tells of. */
export function eventName({ event }: Delivery): string {
  return event === 'ping' ? words.test : words.eventNames[event]
}
