/** The views that have a name; the photo's own is parallel and lies exactly over the photo. */
export type View = 'photo' | 'front' | 'side' | 'back' | 'top'

/** What the preview shows and what it draws with. */
export interface PreviewStatus {
  webgl: 'ok' | 'software' | 'lost' | 'absent'
  view: View | 'free'
  shows: 'empty' | 'live' | 'growing' | 'model'
  leaves: boolean
  triangles: number
  /** What winds there are; none where the file has none. */
  winds: readonly string[]
  /** The one that blows. */
  wind: string | null
}

/** Nothing is shown yet. */
export const NOTHING_SHOWN: PreviewStatus = {
  webgl: 'ok',
  view: 'photo',
  shows: 'empty',
  leaves: true,
  triangles: 0,
  winds: [],
  wind: null,
}
