import { useState } from 'preact/hooks'
import type { Key } from '../../api/types'
import { accountText } from '../../text/account'
import { useStudio } from '../parts/useStore'
import { factsOf, hasEnded } from './keyTexts'
import { Question } from './Question'
import type { Change } from './useTeam'

const { keys: words } = accountText

interface Props {
  readonly keys: readonly Key[]
  /** Whether they are of several members. */
  readonly withMembers?: boolean
  /** Null where they cannot be revoked. */
  readonly change: Change | null
}

/** Keys, those that sign in before those that do so no more, each with what is to be known of it. */
export function KeyList({ keys, withMembers = false, change }: Props) {
  if (!keys.length) return <p class="soft">{words.none}</p>
  const sorted = [...keys].sort(
    (one, other) => Number(hasEnded(one)) - Number(hasEnded(other)) || other.created - one.created,
  )
  return (
    <ul class="account-list">
      {sorted.map(key => (
        <KeyRow key={key.id} of={key} withMember={withMembers} change={change} />
      ))}
    </ul>
  )
}

interface RowProps {
  readonly of: Key
  readonly withMember: boolean
  readonly change: Change | null
}

function KeyRow({ of: key, withMember, change }: RowProps) {
  const { store, accounts } = useStudio()
  const [isAsked, setAsked] = useState(false)
  const ended = hasEnded(key)
  const answer = async (yes: boolean) => {
    setAsked(false)
    if (yes && (await change?.(() => accounts.revokeKey(key.id)))) store.announce(words.revoked(key.name))
  }
  return (
    <li class={ended ? 'account-row is-ended' : 'account-row'}>
      <div class="account-row-words">
        <p class="account-row-name">
          {key.name} <code>{key.beginning}…</code>
        </p>
        <p class="account-facts">{factsOf(key, withMember).join(' · ')}</p>
      </div>
      {change && !ended && !isAsked && (
        <button
          type="button"
          class="button outlined"
          aria-label={words.revokeWhich(key.name)}
          onClick={() => setAsked(true)}
        >
          {words.revoke}
        </button>
      )}
      {isAsked && <Question question={words.question(key.name)} yes={words.revoke} no={words.keep} answer={answer} />}
    </li>
  )
}
