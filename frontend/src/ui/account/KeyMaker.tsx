import type { TargetedEvent } from 'preact'
import { useLayoutEffect, useRef, useState } from 'preact/hooks'
import type { KeyOrder, MadeKey, Member } from '../../api/types'
import { accountText } from '../../text/account'
import { copyText } from '../parts/copying'
import { useStudio } from '../parts/useStore'
import { Choice, NameField } from './Fields'
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
  return made ? <NewKey made={made} done={() => setMade(null)} /> : <KeyForm {...props} take={setMade} />
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

/** A key that was just made: it is seen this once. */
function NewKey({ made, done }: { readonly made: MadeKey; done(): void }) {
  const [copied, setCopied] = useState<boolean | null>(null)
  const field = useRef<HTMLInputElement>(null)
  useLayoutEffect(() => field.current!.select(), [])
  const copy = async () => {
    setCopied(await copyText(made.key))
    field.current?.select()
  }
  return (
    <div class="new-key" role="group" aria-label={words.made(made.name)}>
      <p class="new-key-title">{words.made(made.name)}</p>
      <p>{words.once}</p>
      <div class="new-key-line">
        <input class="account-field" aria-label={words.whole} readOnly value={made.key} ref={field} />
        <button type="button" class="button primary" onClick={copy}>
          {copied ? words.copied : words.copy}
        </button>
        <button type="button" class="button outlined" onClick={done}>
          {words.done}
        </button>
      </div>
      <p role="status">{copied === false && words.copyYourself}</p>
    </div>
  )
}
