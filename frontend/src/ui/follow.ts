import { isOver } from '../api/follow'
import type { Grown } from '../api/types'
import type { Preview } from '../preview/preview'
import type { State, Store } from '../state'
import { onSheet, type Strokes } from '../strokes'
import { text } from '../text'
import { paperUrl } from './drawn'

/** What the preview is to show. */
export type Sight = { readonly kind: 'nothing' } | SkeletonSight | TreeSight

interface SkeletonSight {
  readonly kind: 'live' | 'growth'
  readonly grown: Grown
}

interface TreeSight {
  readonly kind: 'tree'
  readonly glb: ArrayBuffer
}

type Stage = Pick<Preview, 'showPhoto' | 'showLive' | 'playGrowth' | 'showModel' | 'clear'>

const NOTHING: Sight = { kind: 'nothing' }

/** Choose what the preview shows; growth is played only of a model that was `awaited`, not of one opened finished. */
export function sightOf({ shows, grown, growth, tree }: State, awaited: boolean): Sight {
  const live: Sight = grown ? { kind: 'live', grown } : NOTHING
  if (shows === 'live' && grown) return live
  if (tree) return { kind: 'tree', glb: tree }
  return growth && awaited ? { kind: 'growth', grown: growth } : live
}

/** Keep the preview in step with the state; a tree waits until its growth has been played. */
export function followState(store: Store, stage: Stage): void {
  const follower = new Follower(store, stage)
  followPicture(store, stage)
  store.watch(
    state => state,
    state => follower.follow(state),
  )
}

/** Lay over the tree what it was made of: the photo, or the front as it was drawn. */
function followPicture(store: Store, stage: Stage): void {
  let drawn: string | null = null
  store.watch(picturedIn, picture => {
    const before = drawn
    const isDrawing = picture !== null && typeof picture !== 'string'
    drawn = isDrawing ? paperUrl(store.state.photo!, onSheet(picture, 'front')) : null
    stage.showPhoto(isDrawing ? drawn : picture)
    if (before) URL.revokeObjectURL(before)
  })
}

/** Give where the photo is shown from; on bare paper the strokes. */
function picturedIn({ photo, source, history }: State): string | Strokes | null {
  return source === 'sketch' && photo && !photo.url ? history.present : (photo?.url ?? null)
}

class Follower {
  #sight: Sight = NOTHING
  #played = Promise.resolve()
  /** The model that was seen before it was finished. */
  #awaited: string | null = null

  constructor(
    private readonly store: Store,
    private readonly stage: Stage,
  ) {}

  follow(state: State): void {
    const { model } = state
    if (model && !isOver(model)) this.#awaited = model.id
    const next = sightOf(state, model !== null && model.id === this.#awaited)
    if (isSame(next, this.#sight)) return
    const before = this.#sight
    this.#sight = next
    void this.#show(next, before)
  }

  async #show(sight: Sight, before: Sight): Promise<void> {
    if (sight.kind === 'nothing') return this.stage.clear()
    if (sight.kind !== 'tree') return this.#showSkeleton(sight)
    if (before.kind === 'growth') await this.#played
    if (this.#sight === sight) await this.#showTree(sight)
  }

  #showSkeleton({ kind, grown }: SkeletonSight): void {
    if (kind === 'live') this.stage.showLive(grown)
    else this.#played = this.stage.playGrowth(grown)
  }

  async #showTree({ glb }: TreeSight): Promise<void> {
    try {
      await this.stage.showModel(glb)
      this.store.fault('preview', null)
    } catch {
      this.store.fault('preview', { text: text.preview.unreadable })
    }
  }
}

function isSame(one: Sight, other: Sight): boolean {
  return one.kind === other.kind && contentOf(one) === contentOf(other)
}

function contentOf(sight: Sight): unknown {
  if (sight.kind === 'nothing') return null
  return sight.kind === 'tree' ? sight.glb : sight.grown
}
