import { isFinished } from '../api/follow'
import type { Store } from '../state'
import { shownSettings, showsModel, type Trait } from '../taken'
import type { Grower } from './grower'

/** Changes what the tree is taken for. */
export class TakenActions {
  constructor(
    private readonly store: Store,
    private readonly grower: Grower,
  ) {}

  /**
   * Take the tree for a kind or a form, by its name, or leave it to the photo (`auto`); return whether that is a change.
   *
   * The live tree follows by itself. A model that is shown or under way is made again.
   */
  take(trait: Trait, name: string): boolean {
    const { settings, model } = this.store.state
    const isKnown = settings[trait] === name && shownSettings(this.store.state)[trait] === name
    if (isKnown) return false
    const isModel = showsModel(this.store.state) || (model !== null && !isFinished(model.info))
    this.store.set({ settings: { ...settings, [trait]: name } })
    if (isModel) void this.grower.regrow()
    return true
  }
}
