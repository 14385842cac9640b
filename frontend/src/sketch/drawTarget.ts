import type { View } from './viewport'

/** A canvas to draw on, with its device px per CSS px and the view of the sheet in it. */
export interface DrawTarget {
  readonly ctx: CanvasRenderingContext2D
  readonly density: number
  readonly view: View
}
