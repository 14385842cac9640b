import { useState } from 'preact/hooks'
import type { MadeWebhook, Webhook } from '../../api/types'
import { webhooks } from '../../api/webhooks'
import { webhookText as words } from '../../text/webhooks'
import { useStudio } from '../parts/useStore'
import { DeliveryLog } from './DeliveryLog'
import { Question } from './Question'
import type { Change } from './useTeam'
import { factsOf } from './webhookTexts'

interface Props {
  readonly webhook: Webhook
  readonly change: Change
  rotated(made: MadeWebhook): void
}

/** A webhook, with what can be done with it and its log. */
export function WebhookRow({ webhook, change, rotated }: Props) {
  const { store } = useStudio()
  const [asked, setAsked] = useState<'remove' | 'rotate' | null>(null)
  const [isOpen, setOpen] = useState(false)
  const { id, url, enabled } = webhook
  const answer = async (yes: boolean) => {
    setAsked(null)
    if (!yes) return
    if (asked === 'remove') {
      if (await change(() => webhooks.remove(id))) store.announce(words.removed)
      return
    }
    const changed = await change(() => webhooks.change(id, { rotate: true }))
    if (changed) rotated(changed.made)
  }
  const button = (label: string, name: string, act: () => unknown, isPressed?: boolean) => (
    <button type="button" class="button outlined" aria-label={name} aria-expanded={isPressed} onClick={act}>
      {label}
    </button>
  )
  return (
    <li class={enabled ? 'account-row' : 'account-row is-ended'}>
      <div class="account-row-words webhook-words">
        <p class="account-row-name">{url}</p>
        <p class="account-facts">{factsOf(webhook).join(' · ')}</p>
      </div>
      <div class="webhook-buttons">
        {enabled && button(words.ping, words.pingOf(url), () => change(() => webhooks.ping(id)))}
        {button(words.log, words.logOf(url), () => setOpen(!isOpen), isOpen)}
        {enabled
          ? button(words.disable, words.disableOf(url), () => change(() => webhooks.change(id, { enabled: false })))
          : button(words.enable, words.enableOf(url), () => change(() => webhooks.change(id, { enabled: true })))}
        {button(words.rotate, words.rotateOf(url), () => setAsked('rotate'))}
        {button(words.remove, words.removeOf(url), () => setAsked('remove'))}
      </div>
      {asked && (
        <Question
          key={asked}
          question={asked === 'remove' ? words.removeQuestion(url) : words.rotateQuestion}
          yes={asked === 'remove' ? words.remove : words.rotateYes}
          no={words.keep}
          answer={answer}
        />
      )}
      {isOpen && <DeliveryLog webhook={webhook} change={change} />}
    </li>
  )
}
