import { useEffect, useState } from 'preact/hooks'
import type { AuditEntry } from '../../api/types'
import { attempt } from '../../studio/attempt'
import { auditSentence, auditText as words } from '../../text/audit'
import { useStudio } from '../parts/useStore'

/** What was done in the team, by day, the newest first, and what shows older entries. */
export function AuditPart() {
  const { entries, further, more } = useAudit()
  if (!entries) return null
  return (
    <>
      <p class="soft">{words.lead}</p>
      <p class="soft" hidden={entries.length > 0}>
        {words.none}
      </p>
      {[...byDay(entries)].map(([day, done]) => (
        <section key={day} class="account-section">
          <h3>{day}</h3>
          <ul class="account-list">
            {done.map(entry => (
              <li key={entry.id} class="account-row" title={entry.address}>
                <p class="account-row-words">{auditSentence(entry)}</p>
                <time class="soft" dateTime={new Date(entry.at * 1000).toISOString()}>
                  {words.time(entry.at)}
                </time>
              </li>
            ))}
          </ul>
        </section>
      ))}
      <button type="button" class="button outlined" hidden={further === null} onClick={more}>
        {words.more}
      </button>
    </>
  )
}

/** Return the entries so far, null before there are any, where the next page begins, and what loads it. */
function useAudit() {
  const { store, accounts } = useStudio()
  const [entries, setEntries] = useState<readonly AuditEntry[] | null>(null)
  const [further, setFurther] = useState<string | null>(null)
  const more = () =>
    attempt(store, 'account', async () => {
      const page = await accounts.listAudit(further)
      setEntries([...(entries ?? []), ...page.entries])
      setFurther(page.next)
    })
  useEffect(() => void more(), [])
  return { entries, further, more }
}

function byDay(entries: readonly AuditEntry[]): Map<string, AuditEntry[]> {
  const days = new Map<string, AuditEntry[]>()
  for (const entry of entries) {
    const day = words.day(entry.at)
    days.set(day, [...(days.get(day) ?? []), entry])
  }
  return days
}
