import type { AuditEntry, Role } from '../api/types'
import { accountText } from './account'
import { LANGUAGE } from './numbers'

type Details = AuditEntry['details']

const days = new Intl.DateTimeFormat(LANGUAGE, { dateStyle: 'full' })
const times = new Intl.DateTimeFormat(LANGUAGE, { timeStyle: 'short' })

/** What is said of the audit; loaded with the account's dialog. */
export const auditText = {
  lead: 'Who changed members, keys and links, and what was deleted and restored.',
  none: 'Nothing was done yet.',
  more: 'Show older ones',
  operator: 'The operator of this service',
  unknown: 'Somebody',
  day: (at: number) => days.format(at * 1000),
  time: (at: number) => times.format(at * 1000),
} as const

/** By action: what was done, as the end of a sentence that begins with who did it. */
const SENTENCES: Readonly<Record<string, (details: Details) => string>> = {
  'team.made': ({ name }) => `made the team ${quoted(name)}`,
  'team.renamed': ({ name }) => `named the team ${quoted(name)}`,
  'member.added': ({ name, role }) => `added ${name} as ${roleOf(role)}`,
  'member.changed': ({ name, role }) => `made ${name} ${roleOf(role)}`,
  'member.removed': ({ name }) => `removed ${name}`,
  'key.made': ({ name }) => `made the key ${quoted(name)}`,
  'key.revoked': ({ name }) => `revoked the key ${quoted(name)}`,
  signed_in: () => 'signed in',
  signed_out: () => 'signed out',
  'sign_in.refused': ({ name }) => `tried to sign in by the key ${quoted(name)}, which has ended`,
  'share.made': () => 'made a link to a tree',
  'share.revoked': () => 'revoked a link to a tree',
  'model.deleted': () => 'deleted a tree',
  'model.restored': () => 'restored a tree',
  'capture.deleted': () => 'deleted a set of photos',
  'capture.restored': () => 'restored a set of photos',
  'capture_photo.removed': () => 'removed a photo from a set',
  'photo.deleted': () => 'deleted a photo',
  'clip.deleted': () => 'deleted a video',
  'webhook.made': ({ url }) => `made a webhook to ${url}`,
  'webhook.changed': ({ url }) => `changed the webhook to ${url}`,
  'webhook.removed': ({ url }) => `removed the webhook to ${url}`,
}

/** Return what was done as a sentence without its end; of an action that the page does not know, its name. */
export function auditSentence({ who, credential, action, details }: AuditEntry): string {
  const operator = credential === 'command line' ? auditText.operator : auditText.unknown
  return `${who ? who.name || who.id : operator} ${SENTENCES[action]?.(details) ?? action}`
}

function quoted(name: unknown): string {
  return `“${name}”`
}

function roleOf(role: unknown): string {
  return accountText.roles[role as Role]?.toLowerCase() ?? String(role)
}
