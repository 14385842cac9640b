import type { CapturePhoto, CaptureTraceAnswer } from '../../api/types'
import { applied, type Branches } from '../../branches'
import type { Measured } from '../../preview/capture/measured'
import type { Similarity } from '../../preview/capture/similarity'
import type { Editing } from '../../preview/edit/editLayer'
import type { Preview } from '../../preview/preview'
import { captureOf, photoDrawnOn } from '../../sheets'
import type { Capture, State } from '../../state'
import type { Strokes } from '../../strokes'
import { editable, selectedJoint } from '../../studio/edits'
import type { Studio } from '../../studio/studio'
import { tracedInSpace } from '../../tracedOn'

type Stage = Pick<Preview, 'showMeasured' | 'choosePhoto' | 'setEditing' | 'setPictures'>
type Studied = Pick<Studio, 'store'> & { readonly thumbnails: Pick<Studio['thumbnails'], 'of'> }

/** Keep what the preview shows of many photos in step with the state; the call ends it. */
export function followMeasured({ store, thumbnails }: Studied, stage: Stage): () => void {
  const ends = [
    store.watch(usedPhotos, photos => {
      for (const photo of photos)
        void thumbnails.of(photo).then(url => url && stage.setPictures(new Map([[photo.name, url]])))
    }),
    store.watch(photoDrawnOn, photo => stage.choosePhoto(photo)),
    store.watch(kept(measuredOf), measured => stage.showMeasured(measured)),
    store.watch(kept(editingOf), editing => stage.setEditing(editing)),
  ]
  return () => {
    for (const end of ends) end()
  }
}

const NO_PHOTOS: readonly CapturePhoto[] = []

/** Return the photos of a capture whose cameras are known. */
function usedPhotos(state: State): readonly CapturePhoto[] {
  const capture = captureOf(state)
  return capture?.cameras.length ? capture.photos : NO_PHOTOS
}

/** Return what many photos say about the open tree; null where the tree has another source, or no camera was found yet. */
export function measuredOf(state: State): Measured | null {
  const capture = captureOf(state)
  if (!capture?.cameras.length) return null
  const answer = tracedInSpace(state)
  return {
    cameras: capture.cameras,
    cloud: capture.cloud,
    front: frontOf(state.history.present),
    tree: answer && {
      branches: branchesOf(state)!,
      crown: answer.crown,
      treeFromCapture: treeFrom(answer),
    },
  }
}

/** Return the photo that the tree's front is seen in: the first one with a trunk; null before there is one. */
export function frontOf({ views = [] }: Strokes): string | null {
  return views.find(({ branches }) => branches.length > 0)?.photo ?? null
}

/** Return what leads from the capture's frame to the tree's. */
export function treeFrom({ tree_from_capture: rows }: CaptureTraceAnswer): Similarity {
  return rows as unknown as Similarity
}

/** Return the visible branches; edits that the service has not answered are applied to them; null where there are none. */
export function branchesOf({ traced, history }: Pick<State, 'traced' | 'history'>): Branches | null {
  const answer = tracedInSpace({ traced })
  if (!answer || !traced) return null
  const [answered, now] = [traced.of.edits ?? [], history.present.edits ?? []]
  const goesOn = answered.every((edit, at) => edit === now[at])
  return goesOn ? now.slice(answered.length).reduce(applied, answer.skeleton as Branches) : answer.skeleton
}

/** Return how branches are edited; null while they are not. */
export function editingOf(state: State): Editing | null {
  const branches = state.branchTool && captureOf(state) && branchesOf(state)
  if (!branches) return null
  const selected = editable(state) ? selectedJoint(state) : null
  return { tool: state.branchTool!, branches, selected }
}

/** What a value is made of: while this stays the same, so does the value. */
type Basis = readonly [Capture | null, State['traced'], Strokes, State['branchTool'], State['selection']]

/** Return a function that returns the same value again while nothing has changed of what it is made of. */
function kept<T>(make: (state: State) => T): (state: State) => T {
  let last: { basis: Basis; value: T } | null = null
  return state => {
    const basis = [captureOf(state), state.traced, state.history.present, state.branchTool, state.selection] as const
    if (!last || basis.some((part, at) => part !== last!.basis[at])) last = { basis, value: make(state) }
    return last.value
  }
}
