import type { Key, Member, Session } from '../src/api/types'

export const ANN: Member = { id: 'usr_ann', name: 'Ann Bauer', role: 'owner', created: 0 }
export const BO: Member = { id: 'usr_bo', name: 'Bo', role: 'member', created: 1 }

/** Who is signed in: an owner with a key for everything. */
export function session(changes: Partial<Session> = {}): Session {
  const team = { id: 'team_1', name: 'Forest lab' }
  return { hosted: true, member: ANN, team, scopes: ['trees', 'team'], read_only: false, expires: null, ...changes }
}

/** A key of the owner that is used and has not expired. */
export function key(changes: Partial<Key> = {}): Key {
  const times = { created: 0, expires: Date.now() / 1000 + 90 * 86_400, last_used: null, revoked: null }
  const about = { id: 'key_1', name: 'Laptop', beginning: 'ts_ab12', member: ANN }
  return { ...about, scopes: ['trees', 'team'], read_only: false, ...times, ...changes }
}
