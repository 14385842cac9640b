import type { Session } from './api/types'
import type { AccountTab, State } from './state'

/** Why one may look at trees only: by one's role, by a key that only reads, or by one that does not reach trees. */
export type LookingOnly = 'viewer' | 'readOnly' | 'noTrees'

/** Return why one may not draw, grow and delete; null where one may, as everybody may who need not sign in. */
export function lookingOnly(session: Session | null): LookingOnly | null {
  if (!session) return null
  if (session.member.role === 'viewer') return 'viewer'
  if (session.read_only) return 'readOnly'
  return session.scopes.includes('trees') ? null : 'noTrees'
}

const TABS: readonly (string | null)[] = ['keys', 'team', 'webhooks', 'audit', 'limits'] satisfies AccountTab[]

/** Whether an open dialog is a part of one's account. */
export function isAccountTab(dialog: State['dialog']): dialog is AccountTab {
  return TABS.includes(dialog)
}

/** Return the parts of one's account that are open to one: with a key for trees alone one sees no keys. */
export function accountTabs(session: Session): readonly AccountTab[] {
  if (!session.scopes.includes('team')) return ['limits']
  if (session.member.role !== 'owner') return ['keys', 'limits']
  return session.read_only ? ['keys', 'audit', 'limits'] : ['keys', 'team', 'webhooks', 'audit', 'limits']
}
