import { json, request, requestOnce } from './request'
import type { components } from './schema'
import type { Key, KeyOrder, MadeKey, Member, Role, Session, Team } from './types'

type Schemas = components['schemas']

/** The page's calls about who is signed in, and about the team; each may throw `Refused` or `Unreachable`. */
export class Accounts {
  /** Return who is signed in; refused with `unauthenticated` where nobody is. */
  getSession(): Promise<Session> {
    return requestOnce('GET', '/v1/session')
  }

  /** Return how one may sign in beside by a key. */
  getSignInWays(): Promise<Schemas['SignInWays']> {
    return requestOnce('GET', '/v1/sign-in')
  }

  signIn(key: string): Promise<Session> {
    return requestOnce('POST', '/v1/session', json({ key }))
  }

  signOut(): Promise<void> {
    return requestOnce('DELETE', '/v1/session')
  }

  /** Return one's own keys; for an owner those of the whole team. */
  async listKeys(): Promise<readonly Key[]> {
    return (await request<Schemas['KeyList']>('GET', '/v1/keys')).keys
  }

  /** Make a key; the answer alone has it whole. */
  makeKey(order: KeyOrder): Promise<MadeKey> {
    return request('POST', '/v1/keys', json(order))
  }

  revokeKey(id: string): Promise<void> {
    return request('DELETE', `/v1/keys/${id}`)
  }

  /** Return a page of what was done in the team, the newest first; the next one begins `before` what the page says. */
  listAudit(before: string | null): Promise<Schemas['AuditList']> {
    return request('GET', `/v1/audit${before === null ? '' : `?before=${before}`}`)
  }

  async listMembers(): Promise<readonly Member[]> {
    return (await request<Schemas['MemberList']>('GET', '/v1/members')).members
  }

  addMember(name: string, role: Role): Promise<Member> {
    return request('POST', '/v1/members', json({ name, role }))
  }

  changeMember(id: string, change: { readonly role: Role }): Promise<Member> {
    return request('PATCH', `/v1/members/${id}`, json(change))
  }

  removeMember(id: string): Promise<void> {
    return request('DELETE', `/v1/members/${id}`)
  }

  renameTeam(name: string): Promise<Team> {
    return request('PATCH', '/v1/team', json({ name }))
  }
}
