/** What is said where a hosted service allows less than everything. */
export const accessText = {
  /** Why one may look only. */
  lookingOnly: {
    viewer: 'You can look at your team’s trees. To grow your own, ask an owner of the team to make you a member.',
    readOnly: 'You signed in with a key that only reads. To draw and grow, sign in with another key.',
    noTrees: 'You signed in with a key that does not reach trees. To draw and grow, sign in with another key.',
  },
  toGallery: 'Look at the trees',
  waiting: (time: string) => `Too many requests at once. The page goes on by itself in ${time}.`,
  tryAgain: (time: string) => `Try again in ${time}.`,
  stillSignedIn: 'The service does not answer, so you are still signed in. Try again in a moment.',
  account: (name: string) => `Account of ${name}`,
} as const
