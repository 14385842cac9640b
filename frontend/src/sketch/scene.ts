import type { TraceAnswer } from '../api/types'
import type { Selection } from '../state'
import type { Point } from '../strokes'
import type { DrawTarget } from './drawTarget'
import { INK, PAPER_INK } from './ink'
import { Layers } from './layers'
import { drawLevels } from './levels'
import { drawAssumedCrown, drawCursor, drawMarks, drawPenLine, drawTraced } from './overlay'
import type { PenLine } from './penLine'
import { SheetLayer } from './sheetLayer'
import type { SheetView } from './sheetView'
import type { View } from './viewport'

/** What the scene draws that is not part of the page's state. */
export interface SketchStatus {
  readonly view: View
  /** What was traced in this photo. */
  readonly traced: TraceAnswer | null
  readonly hovered: Selection | null
  /** The stroke that is being drawn. */
  readonly pen: PenLine | null
  /** The keyboard's cursor, sheet px; null while it is not shown. */
  readonly cursor: Point | null
}

/** Draws a sheet and all that lies over it. */
export class Scene {
  readonly layers: Layers
  readonly sheet = new SheetLayer(() => this.layers.invalidate('photo'))

  constructor(
    host: HTMLElement,
    private readonly status: () => SketchStatus,
    private readonly shown: () => SheetView,
  ) {
    const painters = {
      photo: (target: DrawTarget) => this.sheet.draw(target, this.shown().isPaper),
      traced: (target: DrawTarget) => this.#drawTraced(target),
      strokes: (target: DrawTarget) => this.#drawMarks(target),
      pen: (target: DrawTarget) => this.#drawPen(target),
    }
    this.layers = new Layers(host, painters, () => status().view)
  }

  #drawTraced(target: DrawTarget): void {
    const { traced } = this.status()
    const { sheet, levels, stray, assumedCrown } = this.shown()
    if (traced && sheet) drawTraced(target, traced, sheet)
    if (assumedCrown) drawAssumedCrown(target, assumedCrown, this.#inks)
    if (levels && sheet) drawLevels(target, { levels, stray, width: sheet.width }, this.#inks)
  }

  get #inks() {
    return this.shown().isPaper ? PAPER_INK : INK
  }

  #drawMarks(target: DrawTarget): void {
    const { sheet, strokes, selection, fault } = this.shown()
    if (!sheet) return
    const { traced, hovered } = this.status()
    drawMarks(target, { strokes, skeleton: traced?.skeleton ?? null, selection, hovered, fault }, this.#inks)
  }

  #drawPen(target: DrawTarget): void {
    const { pen, cursor } = this.status()
    if (pen) drawPenLine(target, pen, this.#inks)
    if (cursor) drawCursor(target, cursor, pen !== null)
  }
}
