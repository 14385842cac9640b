import type { Store } from '../state'
import { readLeaf } from './leafPicture'
import { faultOf } from './sentences'

/** Keeps the person's own picture of a leaf; what is wrong with one stands in the leaf's place of the state. */
export class Herbarium {
  constructor(
    private readonly store: Store,
    private readonly read: (file: Blob, mostBytes: number) => Promise<Blob> = readLeaf,
  ) {}

  /** Take a picture in the place of the last one, which stays where the new one is of no use. */
  async take(file: Blob): Promise<void> {
    const { photo, limits } = this.store.state
    try {
      const leaf = await this.read(file, limits?.leaf_bytes ?? Number.POSITIVE_INFINITY)
      if (this.store.state.photo !== photo) return
      this.store.set({ leaf })
      this.store.fault('leaf', null)
    } catch (error) {
      this.store.fault('leaf', faultOf(error))
    }
  }

  /** Go back to leaves as they come. */
  drop(): void {
    this.store.set({ leaf: null })
    this.store.fault('leaf', null)
  }
}
