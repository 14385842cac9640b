import type { TargetedEvent } from 'preact'
import { useState } from 'preact/hooks'
import type { KeyOrder, MadeKey, Member } from '../../api/types'
import { accountText } from '../../text/account'
import { useStudio } from '../parts/useStore'
import { Choice, NameField } from './Fields'
import { ShownOnce } from './ShownOnce'
import type { Change } from './useTeam'

const { keys: words } = accountText
const DAYS = '90'

type Access = (typeof words.accessChoices)[number][0]
const ACCESS: Readonly<Record<Access, Pick<KeyOrder, 'scopes' | 'read_only'>>> = {
  all: { scopes: ['trees', 'team'], read_only: false },
  trees: { scopes: ['trees'], read_only: false },
  read: { scopes: ['trees'], read_only: true },
}

interface Props {
  readonly change: Change
  /** The members of whom one gets the key; none for one's own. */
  readonly members?: readonly Member[]
  /** The member who is chosen at first, by id. */
  readonly member?: string | undefined
}

/** A form for a new key; once it is made, the key in its place, to be copied. */
export function KeyMaker(props: Props) {
  const [made, setMade] = useState<MadeKey | null>(null)
  if (!made) return <KeyForm {...props} take={setMade} />
  return (
    <ShownOnce
      title={words.made(made.name)}
      lead={words.once}
      label={words.whole}
      value={made.key}
      done={() => setMade(null)}
    />
  )
}

function KeyForm({ change, members, member, take }: Props & { take(made: MadeKey): void }) {
  const { accounts } = useStudio()
  const [name, setName] = useState('')
  const [whose, setWhose] = useState(member ?? members?.[0]?.id)
  const [access, setAccess] = useState<Access>('all')
  const [days, setDays] = useState(DAYS)
  const make = async (event: TargetedEvent<HTMLFormElement>) => {
    event.preventDefault()
    const order = { name: name.trim(), ...ACCESS[access], days: Number(days), ...(whose && { member: whose }) }
    const answer = await change(() => accounts.makeKey(order))
    if (answer) take(answer.made)
  }
  return (
    <form class="account-form" onSubmit={make}>
      <NameField label={words.name} value={name} write={setName} placeholder={words.nameShape} />
      {members && (
        <Choice
          label={words.member}
          choices={members.map(({ id, name: memberName }) => [id, memberName] as const)}
          chosen={whose ?? ''}
          choose={setWhose}
        />
      )}
      <Choice
        label={words.access}
        choices={words.accessChoices}
        chosen={access}
        choose={one => setAccess(one as Access)}
      />
      <Choice label={words.expires} choices={words.expiresChoices} chosen={days} choose={setDays} />
      <button type="submit" class="button primary">
        {words.make}
      </button>
    </form>
  )
}
