import type { OwnPictures, Store } from '../state'
import { readCutOut } from './cutOut'
import { faultOf } from './faultText'

/** Sets a person's own pictures of a leaf and a fruit; faults go to the state. */
export class OwnPictureActions {
  constructor(
    private readonly store: Store,
    private readonly read: (file: Blob, mostBytes: number) => Promise<Blob> = readCutOut,
  ) {}

  /** Use a picture in place of the last one, which stays if the new one cannot be used. */
  async use(file: Blob, kind: keyof OwnPictures = 'leaf'): Promise<void> {
    const { sheets, limits } = this.store.state
    try {
      const picture = await this.read(file, limits?.leaf_bytes ?? Number.POSITIVE_INFINITY)
      if (this.store.state.sheets?.front !== sheets?.front) return
      this.store.set({ [kind]: picture })
      this.store.fault(kind, null)
    } catch (error) {
      this.store.fault(kind, faultOf(error))
    }
  }

  /** Remove an own picture: the species' leaf or no fruit is used again. */
  remove(kind: keyof OwnPictures = 'leaf'): void {
    this.store.set({ [kind]: null })
    this.store.fault(kind, null)
  }
}
