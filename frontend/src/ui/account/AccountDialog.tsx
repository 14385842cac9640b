import { useId } from 'preact/hooks'
import { accountTabs } from '../../access'
import type { Session } from '../../api/types'
import type { AccountTab } from '../../state'
import { accountText } from '../../text/account'
import { useStore, useStudio } from '../parts/useStore'
import { Dialog } from '../start/Dialog'
import { Tabs } from '../tree/Tabs'
import { AuditPart } from './AuditPart'
import { KeyList } from './KeyList'
import { KeyMaker } from './KeyMaker'
import { LimitBars } from './LimitBars'
import { TeamPart } from './TeamPart'
import { type Change, type TeamLists, useTeam } from './useTeam'
import { WebhookPart } from './WebhookPart'
import './accountDialog.css'

const { dialog: words, menu, keys: keyWords } = accountText

/** One's keys, for owners the team and what was done in it, and the limits; the state says which of them is shown. */
export function AccountDialog() {
  const session = useStore(state => state.session)
  return (
    <Dialog title={words.title} class="account-dialog">
      {session && <Parts session={session} />}
    </Dialog>
  )
}

function Parts({ session }: { readonly session: Session }) {
  const { store } = useStudio()
  const id = useId()
  const chosen = useStore(({ dialog }) => dialog) as AccountTab
  const { lists, load, change } = useTeam(session)
  const fault = useStore(({ faults }) => faults.account)
  const parts = {
    keys: lists && <OwnKeys session={session} lists={lists} change={change} />,
    team: lists && <TeamPart session={session} lists={lists} change={change} />,
    audit: chosen === 'audit' && <AuditPart />,
    webhooks: <WebhookPart />,
    limits: <LimitBars />,
  }
  return (
    <>
      <div class="fault account-fault" hidden={!fault}>
        <p role="alert">{fault?.text}</p>
        <button type="button" class="button outlined" hidden={lists !== null} onClick={load}>
          {words.again}
        </button>
      </div>
      <p class="soft" role="status" hidden={lists !== null || Boolean(fault)}>
        {words.loading}
      </p>
      <Tabs
        id={id}
        label={words.tabs}
        tabs={accountTabs(session).map(name => ({ name, label: menu[name], content: parts[name] }))}
        chosen={chosen}
        choose={dialog => store.set({ dialog: dialog as AccountTab })}
      />
    </>
  )
}

interface OwnProps {
  readonly session: Session
  readonly lists: TeamLists
  readonly change: Change
}

function OwnKeys({ session, lists, change }: OwnProps) {
  const own = lists.keys.filter(({ member }) => member.id === session.member.id)
  return (
    <>
      <p class="soft">{keyWords.lead}</p>
      <KeyList keys={own} change={session.read_only ? null : change} />
      {session.read_only ? (
        <p class="account-said">{keyWords.onlyReads}</p>
      ) : (
        <section class="account-section">
          <h3>{keyWords.make}</h3>
          <KeyMaker change={change} />
        </section>
      )}
    </>
  )
}
