import type { ComponentChildren, TargetedMouseEvent } from 'preact'
import { accountTabs, lookingOnly } from '../../access'
import type { Session } from '../../api/types'
import { text } from '../../text'
import { accountText } from '../../text/account'
import { mayLeave } from '../parts/files'
import { Popover } from '../parts/Popover'
import { useStore, useStudio } from '../parts/useStore'
import './accountMenu.css'

const { menu } = accountText

/** The menu of who is signed in. */
export function AccountMenu() {
  const session = useStore(state => state.session)!
  const why = lookingOnly(session)
  const { member, team } = session
  const label = text.access.account(member.name)
  const opener = {
    class: 'button square account-opener',
    'aria-label': label,
    title: label,
    children: <span aria-hidden="true">{initialsOf(member.name)}</span>,
  }
  return (
    <Popover opener={opener} class="account-menu" label={label}>
      <div class="account-who">
        <p class="account-name">{member.name}</p>
        <p class="soft">{menu.place(member.role, team.name)}</p>
        {why && <p class="account-why">{text.access.lookingOnly[why]}</p>}
      </div>
      <Tabs session={session} />
      <SignOut />
    </Popover>
  )
}

function Tabs({ session }: { readonly session: Session }) {
  const { store } = useStudio()
  return (
    <>
      {accountTabs(session).map(tab => (
        <Item key={tab} act={() => store.set({ dialog: tab })}>
          {menu[tab]}
        </Item>
      ))}
    </>
  )
}

function SignOut() {
  const studio = useStudio()
  return (
    <div class="account-out">
      <Item act={() => mayLeave(studio) && studio.session.signOut()}>{menu.signOut}</Item>
      <p class="soft">{menu.signOutWhy}</p>
    </div>
  )
}

function Item({ act, children }: { act(): unknown; readonly children: ComponentChildren }) {
  const run = ({ currentTarget }: TargetedMouseEvent<HTMLButtonElement>) => {
    currentTarget.closest<HTMLElement>('[popover]')?.hidePopover()
    act()
  }
  return (
    <button type="button" class="button" onClick={run}>
      {children}
    </button>
  )
}

/** Return the first letters of the first and the last word of a name. */
function initialsOf(name: string): string {
  const words = name.split(/\s+/).filter(Boolean)
  return [words[0], words.length > 1 ? words.at(-1) : ''].map(word => [...(word ?? '')][0] ?? '').join('')
}
