import type { Store } from '../state'
import { readLeaf } from './leafPicture'
import { faultOf } from './sentences'

/** What a person may have a picture of. */
export type Specimen = 'leaf' | 'fruit'

/** Keeps the person's own pictures; what is wrong with one stands in its place of the state. */
export class Herbarium {
  constructor(
    private readonly store: Store,
    private readonly read: (file: Blob, mostBytes: number) => Promise<Blob> = readLeaf,
  ) {}

  /** Take a picture in the place of the last one, which stays where the new one is of no use. */
  async take(file: Blob, what: Specimen = 'leaf'): Promise<void> {
    const { photo, limits } = this.store.state
    try {
      const picture = await this.read(file, limits?.leaf_bytes ?? Number.POSITIVE_INFINITY)
      if (this.store.state.photo !== photo) return
      this.store.set({ [what]: picture })
      this.store.fault(what, null)
    } catch (error) {
      this.store.fault(what, faultOf(error))
    }
  }

  /** Go back to leaves as they come, and to no fruit. */
  drop(what: Specimen = 'leaf'): void {
    this.store.set({ [what]: null })
    this.store.fault(what, null)
  }
}
