import type { TargetedEvent } from 'preact'
import { useId, useState } from 'preact/hooks'
import type { MadeWebhook, WebhookEvent } from '../../api/types'
import { webhooks } from '../../api/webhooks'
import { webhookText as words } from '../../text/webhooks'
import type { Change } from './useTeam'

const LONGEST_URL = 2000
const EVENTS = Object.keys(words.eventNames) as WebhookEvent[]
const USUAL: readonly WebhookEvent[] = ['model.succeeded', 'model.failed']

interface Props {
  readonly change: Change
  made(webhook: MadeWebhook): void
}

/** A form for a new webhook: its address, and what it is told. */
export function WebhookForm({ change, made }: Props) {
  const id = useId()
  const [url, setUrl] = useState('')
  const [events, setEvents] = useState(USUAL)
  const add = async (event: TargetedEvent<HTMLFormElement>) => {
    event.preventDefault()
    const answer = await change(() => webhooks.make({ url: url.trim(), events: [...events] }))
    if (!answer) return
    setUrl('')
    setEvents(USUAL)
    made(answer.made)
  }
  const choose = (event: WebhookEvent, isChosen: boolean) =>
    setEvents(EVENTS.filter(one => (one === event ? isChosen : events.includes(one))))
  return (
    <form class="account-form" onSubmit={add}>
      <div class="account-labelled webhook-url">
        <label for={id}>{words.url}</label>
        <input
          id={id}
          class="account-field"
          type="url"
          autocomplete="off"
          spellcheck={false}
          placeholder={words.urlShape}
          maxLength={LONGEST_URL}
          required
          value={url}
          onInput={event => setUrl(event.currentTarget.value)}
        />
      </div>
      <fieldset class="webhook-events">
        <legend>{words.events}</legend>
        {EVENTS.map(event => (
          <label key={event}>
            <input
              type="checkbox"
              checked={events.includes(event)}
              onChange={({ currentTarget }) => choose(event, currentTarget.checked)}
            />
            {words.eventNames[event]}
          </label>
        ))}
      </fieldset>
      <button type="submit" class="button primary" disabled={!events.length}>
        {words.addButton}
      </button>
    </form>
  )
}
