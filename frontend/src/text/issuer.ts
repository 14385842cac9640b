/** What is said of signing in at an issuer; loaded with the account's parts. */
export const issuerText = {
  sign: (name: string) => `Sign in with ${name}`,
  elsewhere: 'It opens in another tab. Come back to this one afterwards.',
  or: 'or with a key',
  /** By codes: why signing in did not work. */
  failed: {
    issuer_unavailable: 'Nobody answers there at the moment. Try again later, or sign in with a key.',
    sign_in_over: 'That took too long, or began in another window. Try again.',
    sign_in_refused: 'You were not signed in there. Try again, or sign in with a key.',
    sign_in_invalid: 'The answer from there cannot be trusted, so you are not signed in. Try again.',
    not_member: 'You are in no team here. Ask an owner of the team for a key.',
    rate_limited: 'Signing in has failed too often. Wait a minute, then try again.',
  } as Readonly<Record<string, string>>,
} as const
