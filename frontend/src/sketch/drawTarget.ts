import type { View } from './viewport'

/** A canvas to draw on: its device px per CSS px, and where the sheet lies in it. */
export interface DrawTarget {
  readonly ctx: CanvasRenderingContext2D
  readonly density: number
  readonly view: View
}
