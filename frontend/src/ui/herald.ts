import type { State, Store } from '../state'
import { text } from '../text'
import { judgementOf, matchOf } from './figures'
import { isBusy, type Standing, standingOf, stepOf } from './standing'

const PAUSE_MS = 2500

/** Have screen readers follow a tree on its way: its steps, not more often than one can listen to, and always its end. */
export function heraldGrowth(store: Store, say: (sentence: string) => void, now = () => performance.now()): void {
  let spoken = Number.NEGATIVE_INFINITY
  let awaited = false
  store.watch(stepToSay, step => {
    if (step === null) return
    awaited = true
    if (now() - spoken < PAUSE_MS) return
    spoken = now()
    say(step)
  })
  store.watch(standingOf, standing => {
    if (!awaited || isBusy(standing) || standing === 'bringing') return
    awaited = false
    say(endOf(standing, store.state))
  })
}

function stepToSay(state: State): string | null {
  const standing = standingOf(state)
  if (!isBusy(standing)) return null
  return state.online ? stepOf(standing, state.model) : text.progress.offline
}

function endOf(standing: Standing, { faults, model }: State): string {
  if (faults.grow) return faults.grow.text
  if (standing === 'canceled') return text.grow.standing.canceled
  return model?.status === 'succeeded' ? text.progress.done(`${matchOf(model)}. ${judgementOf(model)}`) : ''
}
