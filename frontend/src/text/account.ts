import type { Role } from '../api/types'
import { bytes, duration, whole } from './numbers'
import { plural } from './plural'

/** What is said where one signs in, and in the account's menu and dialog; loaded with them. */
export const accountText = {
  signIn: {
    title: { first: 'Sign in', again: 'Sign in again' },
    lead: {
      first: 'Teams share this treestroke. Sign in to draw and grow trees in yours.',
      again: 'Your session has ended. Sign in and go on: your drawing is as you left it.',
    },
    key: 'Key',
    shape: 'ts_…',
    sign: 'Sign in',
    signing: 'Signing in …',
    question: 'What is a key?',
    answer: [
      'A key is a line that begins with ts_. It says who you are, so keep it like a password.',
      'An owner of your team makes one for you: on this page in the account’s menu, under Team. It is shown once.',
    ],
    missing: 'Paste your key first.',
  },
  roles: { owner: 'Owner', member: 'Member', viewer: 'Viewer' } satisfies Record<Role, string>,
  /** What the roles may do, where one is chosen. */
  roleChoices: [
    ['owner', 'Owner: also members and keys'],
    ['member', 'Member: draws and grows'],
    ['viewer', 'Viewer: only looks'],
  ],
  menu: {
    place: (role: Role, team: string) => `${accountText.roles[role]} in ${team}`,
    keys: 'Your keys',
    team: 'Team',
    audit: 'Activity',
    webhooks: 'Webhooks',
    limits: 'Limits',
    signOut: 'Sign out',
    signOutWhy: 'Your drawings stay in this browser.',
  },
  dialog: { title: 'Account', tabs: 'Parts of the account', loading: 'Loading …', again: 'Try again' },
  keys: {
    lead: 'A key signs you in here, and lets your programs use this service in your name.',
    onlyReads: 'You signed in with a key that only reads. To make or revoke keys, sign in with another one.',
    none: 'There is no key yet.',
    ofTeam: 'Keys of the team',
    make: 'Make a key',
    name: 'What it is for',
    nameShape: 'My laptop',
    member: 'Whose it is',
    access: 'What it may do',
    accessChoices: [
      ['all', 'Everything'],
      ['trees', 'Trees only'],
      ['read', 'Only look'],
    ],
    expires: 'Expires after',
    /** By days. */
    expiresChoices: [
      ['30', '30 days'],
      ['90', '90 days'],
      ['365', 'a year'],
    ],
    made: (name: string) => `The key “${name}” is made`,
    once: 'Copy it now: it is not shown again. Keep it like a password.',
    whole: 'The key',
    copy: 'Copy',
    copied: 'Copied',
    copyYourself: 'The browser does not allow copying. Select the key and copy it yourself.',
    done: 'Done',
    revoke: 'Revoke',
    revokeWhich: (name: string) => `Revoke ${name}`,
    question: (name: string) => `Revoke “${name}”? Whoever uses it is signed out at once.`,
    keep: 'Keep it',
    revoked: (name: string) => `The key “${name}” is revoked.`,
    facts: {
      read: 'only looks',
      trees: 'trees only',
      all: 'everything',
      onlyTeam: 'team only',
      unused: 'never used',
      used: (when: string) => `used ${when}`,
      expires: (days: number) => plural(days, { one: 'expires in a day', other: 'expires in # days' }),
      expired: 'expired',
      revoked: 'revoked',
    },
  },
  team: {
    name: 'Name of the team',
    rename: 'Rename',
    renamed: (name: string) => `The team is called ${name} now.`,
    members: 'Members',
    you: 'you',
    roleOf: (name: string) => `Role of ${name}`,
    remove: (name: string) => `Remove ${name}`,
    question: (name: string) => `Remove ${name} from the team? Their keys stop at once. Their trees stay.`,
    yes: 'Remove',
    keep: 'Keep',
    removed: (name: string) => `${name} is no longer in the team.`,
    changed: (name: string, role: Role) => `${name} is ${accountText.roles[role].toLowerCase()} now.`,
    add: 'Add a member',
    memberName: 'Name',
    role: 'Role',
    addButton: 'Add',
    added: (name: string) => `${name} is in the team. To sign in they need a key: make one below.`,
  },
  limits: {
    lead: 'What your team has of this service, and how much of it is taken.',
    none: 'This service sets no limits.',
    /** By the names of quotas: what is counted, and how much of it there is. */
    quotas: {
      stored_bytes: [
        'Photos, videos and trees',
        (used, limit) => of(bytes(used), limit === null ? null : bytes(limit), 'stored'),
      ],
      queued: ['Queue', (used, limit) => counted(used, limit, 'waiting')],
      running: ['Growing', (used, limit) => counted(used, limit, 'growing')],
      models_a_day: ['Trees in 24 hours', (used, limit) => counted(used, limit, 'grown')],
      streams: ['Trees watched while they grow', (used, limit) => counted(used, limit, 'watched')],
    } as Readonly<Record<string, readonly [string, (used: number, limit: number | null) => string]>>,
    rates: 'How often you may ask',
    /** By the names of rates. */
    ratesOf: { traces: 'Tracing', models: 'Growing', uploads: 'Sending files', calls: 'Everything else' } as Readonly<
      Record<string, string>
    >,
    /** By their seconds. */
    spans: { 1: 'a second', 60: 'a minute' } as Readonly<Record<number, string>>,
    rate: (requests: number, seconds: number) =>
      `${whole(requests)} times in ${accountText.limits.spans[seconds] ?? duration(seconds)}`,
  },
} as const

function counted(used: number, limit: number | null, what: string): string {
  return of(whole(used), limit === null ? null : whole(limit), what)
}

/** Say how much there is of what is allowed; without a limit, how much there is. */
function of(used: string, limit: string | null, what: string): string {
  return limit === null ? `${used} ${what}, no limit` : `${used} of ${limit} ${what}`
}
