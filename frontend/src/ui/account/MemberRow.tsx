import { useState } from 'preact/hooks'
import type { Member, Role } from '../../api/types'
import { accountText } from '../../text/account'
import { IconButton } from '../parts/IconButton'
import { ICONS } from '../parts/icons'
import { useStudio } from '../parts/useStore'
import { Question } from './Question'
import type { Change } from './useTeam'

const { team: words, roles } = accountText

interface Props {
  readonly member: Member
  readonly isSelf: boolean
  readonly change: Change
}

/** A member of the team, with the role to change and the way out. */
export function MemberRow({ member, isSelf, change }: Props) {
  const { store, accounts, session } = useStudio()
  const [isAsked, setAsked] = useState(false)
  const { id, name } = member
  const changeRole = async (select: HTMLSelectElement) => {
    const role = select.value as Role
    const changed = await change(() => accounts.changeMember(id, { role }))
    if (!changed) select.value = member.role
    else store.announce(words.changed(name, role))
    if (changed && isSelf) await session.find() // the page offers what the new role may do
  }
  const answer = async (yes: boolean) => {
    setAsked(false)
    if (yes && (await change(() => accounts.removeMember(id)))) store.announce(words.removed(name))
  }
  return (
    <li class="account-row">
      <p class="account-row-words account-row-name">
        {name} {isSelf && <span class="account-tag">{words.you}</span>}
      </p>
      <select
        class="account-field"
        aria-label={words.roleOf(name)}
        value={member.role}
        onChange={event => void changeRole(event.currentTarget)}
      >
        {Object.entries(roles).map(([role, label]) => (
          <option value={role} key={role}>
            {label}
          </option>
        ))}
      </select>
      {!isAsked && <IconButton label={words.remove(name)} icon={ICONS.remove} onClick={() => setAsked(true)} />}
      {isAsked && <Question question={words.question(name)} yes={words.yes} no={words.keep} answer={answer} />}
    </li>
  )
}
