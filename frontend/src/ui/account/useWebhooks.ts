import { useEffect, useState } from 'preact/hooks'
import type { Webhook } from '../../api/types'
import { webhooks } from '../../api/webhooks'
import { attempt } from '../../studio/attempt'
import { useStudio } from '../parts/useStore'
import type { Change } from './useTeam'

const LOOK_MS = 2000

/** Return the team's webhooks, null until they are there, with what changes them; faults go to the state. */
export function useWebhooks() {
  const { store } = useStudio()
  const [listed, setListed] = useState<readonly Webhook[] | null>(null)
  const list = async () => setListed(await webhooks.list())
  const change: Change = call =>
    attempt(store, 'account', async () => {
      const made = await call()
      await list()
      return { made }
    })
  useEffect(() => void attempt(store, 'account', list), [])
  const isSending = listed?.some(({ last_delivery: last }) => last?.state === 'waiting') ?? false
  useEffect(() => {
    const timer = isSending ? setInterval(() => attempt(store, 'account', list), LOOK_MS) : undefined
    return () => clearInterval(timer)
  }, [isSending])
  return { listed, change }
}
