import type { Part } from './capture/measured'

/** The named views; `photo` lies exactly over the photo, that of many which is chosen. */
export type View = 'photo' | 'front' | 'side' | 'back' | 'top'

/** What the preview shows, and how. */
export interface PreviewStatus {
  webgl: 'ok' | 'software' | 'lost' | 'absent'
  view: View | 'free'
  /** `measured`: what many photos say about a tree, but no tree. */
  shows: 'empty' | 'measured' | 'live' | 'growing' | 'model'
  leaves: boolean
  triangles: number
  /** The names of the file's animations. */
  animations: readonly string[]
  /** The animation that is played; null where the tree stands still. */
  animation: string | null
  /** How far branches turn from their means, as a factor. */
  gain: number
  /** The parts of what many photos say, and whether they are shown; null where there are none. */
  parts: Readonly<Partial<Record<Part, boolean>>> | null
  /** Whether there is a photo's view: a photo of many has one where its camera was found. */
  hasPhotoView: boolean
}

/** The status before anything is shown. */
export const NOTHING_SHOWN: PreviewStatus = {
  webgl: 'ok',
  view: 'photo',
  shows: 'empty',
  leaves: true,
  triangles: 0,
  animations: [],
  animation: null,
  gain: 1,
  parts: null,
  hasPhotoView: true,
}
