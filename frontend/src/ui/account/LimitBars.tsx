import { useEffect, useState } from 'preact/hooks'
import type { Limits, Quota } from '../../api/types'
import { attempt } from '../../studio/attempt'
import { accountText } from '../../text/account'
import { useStudio } from '../parts/useStore'

const { limits: words } = accountText
/** From this share on a quota is nearly taken. */
const NEARLY = 0.9
const LOOK_MS = 5000

/** How much of its quotas the team has taken, as bars, and how often one may ask. */
export function LimitBars() {
  const limits = useLimits()
  if (!limits) return null
  const { quotas, rates } = limits
  if (!quotas.length && !rates.length) return <p class="soft">{words.none}</p>
  return (
    <>
      <p class="soft">{words.lead}</p>
      {quotas.map(quota => (
        <Bar key={quota.name} quota={quota} />
      ))}
      <section class="account-section" hidden={!rates.length}>
        <h3>{words.rates}</h3>
        <dl class="account-rates">
          {rates.map(({ name, requests, seconds }) => (
            <div key={name}>
              <dt>{words.ratesOf[name] ?? name}</dt>
              <dd>{words.rate(requests, seconds)}</dd>
            </div>
          ))}
        </dl>
      </section>
    </>
  )
}

/** Return the limits as they are now, again and again while they are looked at. */
function useLimits(): Limits | null {
  const { store, client } = useStudio()
  const [limits, setLimits] = useState<Limits | null>(null)
  useEffect(() => {
    const look = () => attempt(store, 'account', async () => setLimits(await client.getLimits()))
    void look()
    const timer = setInterval(look, LOOK_MS)
    return () => clearInterval(timer)
  }, [])
  return limits
}

function Bar({ quota: { name, limit, used } }: { readonly quota: Quota }) {
  const [label, sentence] = words.quotas[name] ?? [name, (taken: number) => String(taken)]
  const share = limit ? Math.min(used / limit, 1) : 0
  const said = sentence(used, limit)
  return (
    <div class={share >= NEARLY ? 'quota is-nearly' : 'quota'}>
      <p class="quota-words">
        <span>{label}</span>
        <span class="quota-said">{said}</span>
      </p>
      <div
        class="quota-bar"
        role="meter"
        aria-label={label}
        aria-valuemin={0}
        aria-valuemax={limit || used}
        aria-valuenow={Math.min(used, limit || used)}
        aria-valuetext={said}
        hidden={!limit}
      >
        <div class="quota-taken" style={{ '--taken': String(share) }} />
      </div>
    </div>
  )
}
