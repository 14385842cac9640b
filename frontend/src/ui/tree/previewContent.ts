import { isFinished } from '../../api/follow'
import type { Grown } from '../../api/types'
import type { Preview } from '../../preview/preview'
import type { State, Store } from '../../state'
import { onSheet, type Strokes } from '../../strokes'
import { text } from '../../text'
import { paperUrl } from '../parts/drawn'

/** What the preview is to show. */
export type PreviewContent = { readonly kind: 'nothing' } | SkeletonContent | TreeContent

interface SkeletonContent {
  readonly kind: 'live' | 'growth'
  readonly grown: Grown
}

interface TreeContent {
  readonly kind: 'tree'
  readonly glb: ArrayBuffer
}

type Stage = Pick<Preview, 'showPhoto' | 'showLive' | 'playGrowth' | 'showModel' | 'clear'>

const NOTHING: PreviewContent = { kind: 'nothing' }

/** Choose what the preview shows; growth is played only of a model that was `awaited`, not of one opened finished. */
export function contentOf({ shows, liveTree, model }: State, awaited: boolean): PreviewContent {
  const live: PreviewContent = liveTree ? { kind: 'live', grown: liveTree } : NOTHING
  if (shows === 'live' && liveTree) return live
  if (model?.glb) return { kind: 'tree', glb: model.glb }
  return model?.growth && awaited ? { kind: 'growth', grown: model.growth } : live
}

/** Keep the preview in step with the state; a tree waits until its growth has been played. The call ends it. */
export function followState(store: Store, stage: Stage): () => void {
  const follower = new Follower(store, stage)
  const endPicture = followPicture(store, stage)
  const endContent = store.watch(
    state => state,
    state => follower.follow(state),
  )
  return () => {
    endPicture()
    endContent()
  }
}

/** Lay over the tree what it was made of: the photo, or the front as it was drawn. */
function followPicture(store: Store, stage: Stage): () => void {
  let drawn: string | null = null
  const end = store.watch(pictureIn, picture => {
    const before = drawn
    const isDrawing = picture !== null && typeof picture !== 'string'
    drawn = isDrawing ? paperUrl(store.state.sheets!.front, onSheet(picture, 'front')) : null
    stage.showPhoto(isDrawing ? drawn : picture)
    if (before) URL.revokeObjectURL(before)
  })
  return () => {
    end()
    if (drawn) URL.revokeObjectURL(drawn)
  }
}

/** Return where the photo is shown from; on bare paper the strokes. */
function pictureIn({ sheets, history }: State): string | Strokes | null {
  return isBareDrawing({ sheets }) ? history.present : (sheets?.front.url ?? null)
}

/** Whether the tree is sketched with no photo under the front. */
export function isBareDrawing({ sheets }: Pick<State, 'sheets'>): boolean {
  return sheets?.source === 'sketch' && !sheets.front.url
}

class Follower {
  #content: PreviewContent = NOTHING
  #played = Promise.resolve()
  /** The model that was seen before it was finished. */
  #awaited: string | null = null

  constructor(
    private readonly store: Store,
    private readonly stage: Stage,
  ) {}

  follow(state: State): void {
    const info = state.model?.info
    if (info && !isFinished(info)) this.#awaited = info.id
    const next = contentOf(state, info !== undefined && info.id === this.#awaited)
    if (isSame(next, this.#content)) return
    const before = this.#content
    this.#content = next
    void this.#show(next, before)
  }

  async #show(content: PreviewContent, before: PreviewContent): Promise<void> {
    if (content.kind === 'nothing') return this.stage.clear()
    if (content.kind !== 'tree') return this.#showSkeleton(content)
    if (before.kind === 'growth') await this.#played
    if (this.#content === content) await this.#showTree(content)
  }

  #showSkeleton({ kind, grown }: SkeletonContent): void {
    if (kind === 'live') this.stage.showLive(grown)
    else this.#played = this.stage.playGrowth(grown)
  }

  async #showTree({ glb }: TreeContent): Promise<void> {
    try {
      await this.stage.showModel(glb)
      this.store.fault('preview', null)
    } catch {
      this.store.fault('preview', { text: text.preview.unreadable })
    }
  }
}

function isSame(one: PreviewContent, other: PreviewContent): boolean {
  return one.kind === other.kind && partOf(one) === partOf(other)
}

function partOf(content: PreviewContent): unknown {
  if (content.kind === 'nothing') return null
  return content.kind === 'tree' ? content.glb : content.grown
}
