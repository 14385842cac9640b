import { useEffect, useState } from 'preact/hooks'
import type { Delivery, Webhook } from '../../api/types'
import { webhooks } from '../../api/webhooks'
import { attempt } from '../../studio/attempt'
import { webhookText as words } from '../../text/webhooks'
import { useStudio } from '../parts/useStore'
import type { Change } from './useTeam'
import { eventName, outcomeOf } from './webhookTexts'

interface Props {
  readonly webhook: Webhook
  readonly change: Change
}

interface Log {
  readonly deliveries: readonly Delivery[]
  readonly next: string | null
}

/** The messages to a webhook, newest first, with what became of each. */
export function DeliveryLog({ webhook, change }: Props) {
  const { store } = useStudio()
  const [log, setLog] = useState<Log | null>(null)
  const { id, last_delivery: last } = webhook
  const load = async () => setLog(await webhooks.deliveries(id))
  const more = async () => {
    const page = await webhooks.deliveries(id, log!.next)
    setLog({ ...page, deliveries: [...log!.deliveries, ...page.deliveries] })
  }
  const resend = (delivery: Delivery) => change(() => webhooks.resend(delivery.id).then(load))
  useEffect(() => void attempt(store, 'account', load), [id, last?.id, last?.state, last?.attempts])
  if (!log) return <p class="soft webhook-log">{words.loading}</p>
  if (!log.deliveries.length) return <p class="soft webhook-log">{words.logEmpty}</p>
  return (
    <div class="webhook-log">
      <ul class="account-list">
        {log.deliveries.map(delivery => (
          <li class="account-row" key={delivery.id}>
            <div class="account-row-words">
              <p>{eventName(delivery)}</p>
              <p class="account-facts">{outcomeOf(delivery).join(' · ')}</p>
            </div>
            {webhook.enabled && (
              <button
                type="button"
                class="button outlined"
                aria-label={words.resendOf(eventName(delivery))}
                onClick={() => resend(delivery)}
              >
                {words.resend}
              </button>
            )}
          </li>
        ))}
      </ul>
      {log.next && (
        <button type="button" class="button outlined" onClick={() => attempt(store, 'account', more)}>
          {words.more}
        </button>
      )}
    </div>
  )
}
