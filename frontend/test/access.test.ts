import { expect, test } from 'vitest'
import { accountTabs, lookingOnly } from '../src/access'
import { ANN, BO, session } from './accounts'

test('everybody may draw where nobody signs in; else all but viewers and keys that only read or do not reach trees', () => {
  const viewer = session({ member: { ...BO, role: 'viewer' } })
  const sessions = [null, session(), viewer, session({ read_only: true }), session({ scopes: ['team'] })]
  expect(sessions.map(lookingOnly)).toEqual([null, null, 'viewer', 'readOnly', 'noTrees'])
})

test('owners see the team, others their keys, and a key for trees alone only the limits', () => {
  const sessions = [session(), session({ member: BO }), session({ member: ANN, scopes: ['trees'] })]
  const all = ['keys', 'team', 'webhooks', 'audit', 'limits']
  expect(sessions.map(accountTabs)).toEqual([all, ['keys', 'limits'], ['limits']])
})
