import { useEffect, useState } from 'preact/hooks'
import { issuerText as words } from '../../text/issuer'
import { useStudio } from '../parts/useStore'
import { modelInAddress } from '../start/session'

const FAILED = 'sign-in'

/** The way to the issuer, where the service has one, and what went wrong when one last came back from it. */
export function IssuerSignIn({ isAgain }: { readonly isAgain: boolean }) {
  const name = useIssuer()
  const [failed] = useState(takeFailure)
  if (!name) return null
  const model = modelInAddress()
  return (
    <div class="sign-in-issuer">
      <a
        class="button primary"
        href={`/v1/session/oidc${model ? `?model=${model}` : ''}`}
        // What is drawn stays open here.
        target={isAgain ? '_blank' : undefined}
      >
        {words.sign(name)}
      </a>
      {failed && (
        <p class="fault" role="alert">
          {failed}
        </p>
      )}
      {isAgain && <p class="soft">{words.elsewhere}</p>}
      <p class="sign-in-or">{words.or}</p>
    </div>
  )
}

/** Return the issuer's name; null as long as none is known. */
function useIssuer(): string | null {
  const { accounts } = useStudio()
  const [name, setName] = useState<string | null>(null)
  useEffect(() => {
    accounts.getSignInWays().then(
      ({ oidc }) => setName(oidc?.name ?? null),
      () => {}, // a key is enough
    )
  }, [accounts])
  return name
}

/** Return what the address says went wrong, and take it out of there, so that it is said once. */
function takeFailure(): string | null {
  const asked = new URLSearchParams(location.search)
  const code = asked.get(FAILED)
  if (code === null) return null
  history.replaceState(null, '', location.pathname + location.hash)
  return words.failed[code] ?? words.failed.sign_in_invalid!
}
