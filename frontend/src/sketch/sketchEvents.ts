import type { Selection } from '../state'
import type { Line, Point } from '../strokes'
import type { DrawnKind } from './gesture'
import type { View } from './viewport'

/** What a sheet is called, for screen readers. */
export interface SketchLabels {
  /** The canvas's name. */
  readonly canvas: string
  /** How to draw by keyboard. */
  readonly keys: string
}

/** What happens on a sheet. */
export interface SketchEvents {
  /** The sheet was touched, or has the focus. */
  touched(): void
  /** A stroke was finished; sheet px. */
  drew(kind: DrawnKind, points: Line): void
  /** Something was selected; null: nothing is. */
  selected(selection: Selection | null): void
  /** The selected stroke or branch should be removed. */
  remove(): void
  /** The view changed; `whole` where the whole sheet is fitted in the window. */
  looked(view: View, whole: boolean): void
  /** The keyboard's pen was put down, lifted or moved; sheet px. */
  said(what: { pen: 'down' | 'up' | 'move'; at: Point }): void
}
