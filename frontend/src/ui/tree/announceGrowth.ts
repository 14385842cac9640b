import type { Store } from '../../state'
import { growthStatusOf, isBusy } from './growthStatus'
import { endOf, stepOf } from './growthText'

const PAUSE_MS = 2500

/** Have screen readers say a tree's steps, no oftener than one can listen to, and always its end; the call ends it. */
export function announceGrowth(store: Store, now = () => performance.now()): () => void {
  let spoken = Number.NEGATIVE_INFINITY
  let awaited = false
  const endSteps = store.watch(stepOf, step => {
    if (step === null) return
    awaited = true
    if (now() - spoken < PAUSE_MS) return
    spoken = now()
    store.announce(step)
  })
  const endEnds = store.watch(growthStatusOf, status => {
    if (!awaited || isBusy(status) || status === 'loading') return
    awaited = false
    store.announce(endOf(store.state))
  })
  return () => {
    endSteps()
    endEnds()
  }
}
