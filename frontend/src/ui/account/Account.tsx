import { useLoaded } from '../parts/useLoaded'
import { useStore } from '../parts/useStore'

/** The account's menu in the head; nothing where nobody needs to sign in. */
export function Account() {
  const Parts = useParts()
  const isIn = useStore(({ session }) => session !== null)
  return isIn && Parts ? <Parts.AccountMenu /> : null
}

/** The sign-in over the page while it is needed. */
export function SignIn() {
  const Parts = useParts()
  const isAsked = useStore(({ signIn }) => signIn !== null)
  return isAsked && Parts ? <Parts.SignInScreen /> : null
}

/** The dialog with keys, team and limits. */
export function AccountTabs() {
  const Parts = useParts()
  return Parts && <Parts.AccountDialog />
}

/** Return the parts of a hosted service's page once it turns out to be one. */
function useParts() {
  const isHosted = useStore(({ session, signIn }) => session !== null || signIn !== null)
  return useLoaded(async () => (isHosted ? import('./accountParts') : null), [isHosted])
}
