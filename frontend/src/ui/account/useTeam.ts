import { useEffect, useState } from 'preact/hooks'
import { accountTabs } from '../../access'
import type { Key, Member, Session } from '../../api/types'
import { attempt } from '../../studio/attempt'
import { useStudio } from '../parts/useStore'

/** One's keys and, for owners, those of the whole team and its members. */
export interface TeamLists {
  readonly keys: readonly Key[]
  readonly members: readonly Member[]
}

/** Makes a change, then lists everything anew; resolves to what the call returned in a box, or null after a fault. */
export type Change = <T>(call: () => Promise<T>) => Promise<{ readonly made: T } | null>

/** Return the lists, null until they are there, with what changes them and what loads them again; faults go to the state. */
export function useTeam(session: Session) {
  const { store, accounts } = useStudio()
  const [lists, setLists] = useState<TeamLists | null>(null)
  const tabs = accountTabs(session)
  const list = async () => {
    const [keys, members] = await Promise.all([
      tabs.includes('keys') ? accounts.listKeys() : [],
      tabs.includes('team') ? accounts.listMembers() : [],
    ])
    setLists({ keys, members })
  }
  const load = () => attempt(store, 'account', list)
  const change: Change = call =>
    attempt(store, 'account', async () => {
      const made = await call()
      await list()
      return { made }
    })
  useEffect(() => void load(), [])
  return { lists, load, change }
}
