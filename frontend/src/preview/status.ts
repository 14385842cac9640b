/** The named views; `photo` lies exactly over the photo. */
export type View = 'photo' | 'front' | 'side' | 'back' | 'top'

/** What the preview shows, and how. */
export interface PreviewStatus {
  webgl: 'ok' | 'software' | 'lost' | 'absent'
  view: View | 'free'
  shows: 'empty' | 'live' | 'growing' | 'model'
  leaves: boolean
  triangles: number
  /** The names of the file's winds. */
  winds: readonly string[]
  /** The wind that is played. */
  wind: string | null
}

/** The status before anything is shown. */
export const NOTHING_SHOWN: PreviewStatus = {
  webgl: 'ok',
  view: 'photo',
  shows: 'empty',
  leaves: true,
  triangles: 0,
  winds: [],
  wind: null,
}
