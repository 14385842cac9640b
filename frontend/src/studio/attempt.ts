import type { Place, Store } from '../state'
import { faultOf } from './faultText'

/** Return what a call returns, or put its error among the faults of a place and return null. */
export async function attempt<T>(store: Store, place: Place, call: () => Promise<T>): Promise<T | null> {
  try {
    const answer = await call()
    store.fault(place, null)
    return answer
  } catch (error) {
    store.fault(place, faultOf(error))
    return null
  }
}
