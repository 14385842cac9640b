import { useState } from 'preact/hooks'
import type { MadeWebhook } from '../../api/types'
import { webhookText as words } from '../../text/webhooks'
import { ShownOnce } from './ShownOnce'
import { useWebhooks } from './useWebhooks'
import { WebhookForm } from './WebhookForm'
import { WebhookRow } from './WebhookRow'

/** A secret that was just made, and what it was made for. */
interface Secret {
  readonly title: string
  readonly value: string
}

/** What an owner sees and changes of the addresses that are told about the team's trees. */
export function WebhookPart() {
  const { listed, change } = useWebhooks()
  const [secret, setSecret] = useState<Secret | null>(null)
  const take = (title: string) => (made: MadeWebhook) => made.secret && setSecret({ title, value: made.secret })
  return (
    <>
      <p class="soft">{words.lead}</p>
      {listed?.length === 0 && <p class="soft">{words.none}</p>}
      {listed && listed.length > 0 && (
        <ul class="account-list">
          {listed.map(webhook => (
            <WebhookRow key={webhook.id} webhook={webhook} change={change} rotated={take(words.rotated)} />
          ))}
        </ul>
      )}
      {secret && (
        <ShownOnce
          key={secret.value}
          title={secret.title}
          lead={words.once}
          label={words.secret}
          value={secret.value}
          done={() => setSecret(null)}
        />
      )}
      <section class="account-section">
        <h3>{words.add}</h3>
        <WebhookForm change={change} made={take(words.made)} />
      </section>
    </>
  )
}
