import { LANGUAGE } from './numbers'

const day = new Intl.DateTimeFormat(LANGUAGE, { dateStyle: 'medium' })

/** What is said of links to a tree. */
export const sharingText = {
  title: 'Share',
  lead: 'Anybody who has the link sees this tree in 3D, without signing in.',
  days: 'The link works for',
  dayCounts: { 1: '1 day', 7: '7 days', 30: '30 days', 365: '1 year' } as Readonly<Record<number, string>>,
  photo: 'Show the photo, too',
  download: 'Offer the tree for download',
  make: 'Make link',
  made: 'The link. It is shown only now:',
  copy: 'Copy',
  copied: 'Copied',
  links: 'Links to this tree',
  none: 'There are no links to this tree.',
  until: (time: string) => `works until ${day.format(new Date(time))}`,
  revokedOn: (time: string) => `revoked on ${day.format(new Date(time))}`,
  endedOn: (time: string) => `ended on ${day.format(new Date(time))}`,
  withPhoto: 'with the photo',
  withoutDownload: 'without download',
  revoke: 'Revoke',
  revokeOf: (time: string) => `Revoke the link of ${new Date(time).toLocaleString(LANGUAGE)}`,
  revoked: 'The link is revoked.',
} as const
