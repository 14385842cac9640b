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
  /** One stroke is finished, in photo px. */
  drew(kind: DrawnKind, points: Line): void
  selected(selection: Selection | null): void
  /** What is selected is to go. */
  remove(): void
  /** Where the photo lies in the window now, and whether the whole of it is in sight. */
  looked(view: View, whole: boolean): void
  /** What the keyboard's pen does, in photo px. */
  said(what: { pen: 'down' | 'up' | 'move'; at: Point }): void
}
