import type { TargetedEvent } from 'preact'
import { useState } from 'preact/hooks'
import type { Member, Role, Session } from '../../api/types'
import { accountText } from '../../text/account'
import { useStudio } from '../parts/useStore'
import { Choice, NameField } from './Fields'
import { KeyList } from './KeyList'
import { KeyMaker } from './KeyMaker'
import { MemberRow } from './MemberRow'
import type { Change, TeamLists } from './useTeam'

const { team: words, keys: keyWords, roleChoices } = accountText

interface Props {
  readonly session: Session
  readonly lists: TeamLists
  readonly change: Change
}

/** What an owner sees and changes: the team's name, its members and all of its keys. */
export function TeamPart({ session, lists: { members, keys }, change }: Props) {
  const [added, setAdded] = useState<Member | null>(null)
  return (
    <>
      <TeamName session={session} change={change} />
      <section class="account-section">
        <h3>{words.members}</h3>
        <ul class="account-list">
          {members.map(member => (
            <MemberRow key={member.id} member={member} isSelf={member.id === session.member.id} change={change} />
          ))}
        </ul>
        <AddMember change={change} added={setAdded} />
        <p class="account-said" role="status">
          {added && words.added(added.name)}
        </p>
      </section>
      <section class="account-section">
        <h3>{keyWords.ofTeam}</h3>
        <KeyList keys={keys} withMembers change={change} />
        <KeyMaker key={added?.id} change={change} members={members} member={added?.id} />
      </section>
    </>
  )
}

function TeamName({ session, change }: Pick<Props, 'session' | 'change'>) {
  const { store, accounts, session: actions } = useStudio()
  const [name, setName] = useState(session.team.name)
  const isNew = name.trim() !== '' && name.trim() !== session.team.name
  const rename = async (event: TargetedEvent<HTMLFormElement>) => {
    event.preventDefault()
    if (!isNew || !(await change(() => accounts.renameTeam(name.trim())))) return
    store.announce(words.renamed(name.trim()))
    await actions.find()
  }
  return (
    <form class="account-form is-line" onSubmit={rename}>
      <NameField label={words.name} value={name} write={setName} />
      <button type="submit" class="button outlined" aria-disabled={!isNew}>
        {words.rename}
      </button>
    </form>
  )
}

function AddMember({ change, added }: { readonly change: Change; added(member: Member): void }) {
  const { accounts } = useStudio()
  const [name, setName] = useState('')
  const [role, setRole] = useState<Role>('member')
  const add = async (event: TargetedEvent<HTMLFormElement>) => {
    event.preventDefault()
    const answer = await change(() => accounts.addMember(name.trim(), role))
    if (!answer) return
    setName('')
    added(answer.made)
  }
  return (
    <form class="account-form is-line" aria-label={words.add} onSubmit={add}>
      <NameField label={words.memberName} value={name} write={setName} />
      <Choice label={words.role} choices={roleChoices} chosen={role} choose={one => setRole(one as Role)} />
      <button type="submit" class="button outlined">
        {words.addButton}
      </button>
    </form>
  )
}
