import type { TraceAnswer } from '../api/types'
import type { Selection } from '../state'
import type { Point } from '../strokes'
import type { DrawTarget } from './drawTarget'
import { INK, PAPER_INK } from './ink'
import { Layers } from './layers'
import { drawLevels } from './levels'
import { drawAim, drawCrownTaken, drawMarks, drawPenLine, drawTraced } from './overlay'
import type { PenLine } from './penLine'
import { PhotoLayer } from './photoLayer'
import type { SheetView } from './sheetView'
import type { View } from './viewport'

/** What is seen beside the page's state. */
export interface SketchStatus {
  readonly view: View
  /** What was traced of this photo. */
  readonly traced: TraceAnswer | null
  readonly hovered: Selection | null
  /** The stroke under way. */
  readonly pen: PenLine | null
  /** Where the keyboard's pen is, photo px. */
  readonly aim: Point | null
}

/** Paints the photo and what lies over it. */
export class Scene {
  readonly layers: Layers
  readonly picture = new PhotoLayer(() => this.layers.touch('photo'))

  constructor(
    host: HTMLElement,
    private readonly status: () => SketchStatus,
    private readonly shown: () => SheetView,
  ) {
    const paint = {
      photo: (target: DrawTarget) => this.picture.draw(target, this.shown().isPaper),
      traced: (target: DrawTarget) => this.#drawTraced(target),
      strokes: (target: DrawTarget) => this.#drawMarks(target),
      pen: (target: DrawTarget) => this.#drawPen(target),
    }
    this.layers = new Layers(host, paint, () => status().view)
  }

  #drawTraced(target: DrawTarget): void {
    const { traced } = this.status()
    const { sheet, levels, stray, crown } = this.shown()
    if (traced && sheet) drawTraced(target, traced)
    if (crown) drawCrownTaken(target, crown, this.#inks)
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
    const { pen, aim } = this.status()
    if (pen) drawPenLine(target, pen, this.#inks)
    if (aim) drawAim(target, aim, pen !== null)
  }
}
