import type { Key } from '../../api/types'
import { accountText } from '../../text/account'
import { ago } from '../start/when'

const DAY_S = 86_400
const { facts } = accountText.keys

/** Whether a key signs in no more. */
export function hasEnded({ revoked, expires }: Key, now = Date.now() / 1000): boolean {
  return revoked !== null || expires <= now
}

/** Return what is to be known of a key, as short phrases; with whose it is where that is not plain. */
export function factsOf(key: Key, withMember: boolean, now = Date.now() / 1000): string[] {
  const used = key.last_used === null ? facts.unused : facts.used(ago(key.last_used * 1000, now * 1000))
  return [...(withMember ? [key.member.name] : []), accessOf(key), used, endOf(key, now)]
}

function accessOf({ read_only: onlyReads, scopes }: Key): string {
  if (onlyReads) return facts.read
  if (!scopes.includes('team')) return facts.trees
  return scopes.includes('trees') ? facts.all : facts.onlyTeam
}

function endOf({ revoked, expires }: Key, now: number): string {
  if (revoked !== null) return facts.revoked
  return expires <= now ? facts.expired : facts.expires(Math.ceil((expires - now) / DAY_S))
}
