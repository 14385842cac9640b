import type { Selection, TraceAnswer } from '../state'
import type { Point } from '../strokes'
import { INK, PAPER_INK } from './ink'
import { Layers } from './layers'
import { drawLevels } from './levels'
import { drawAim, drawCrownTaken, drawMarks, drawPenLine, drawTraced, type Sheet } from './overlay'
import type { PenLine } from './penLine'
import { PhotoLayer } from './photoLayer'
import type { SheetSight } from './sheet'
import type { View } from './viewport'

/** What is seen beside the page's state. */
export interface Sight {
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
    private readonly sight: () => Sight,
    private readonly shown: () => SheetSight,
  ) {
    const paint = {
      photo: (sheet: Sheet) => this.picture.draw(sheet, this.shown().isPaper),
      traced: (sheet: Sheet) => this.#drawTraced(sheet),
      strokes: (sheet: Sheet) => this.#drawMarks(sheet),
      pen: (sheet: Sheet) => this.#drawPen(sheet),
    }
    this.layers = new Layers(host, paint, () => sight().view)
  }

  #drawTraced(sheet: Sheet): void {
    const { traced } = this.sight()
    const { ground, levels, stray, crown } = this.shown()
    if (traced && ground) drawTraced(sheet, traced)
    if (crown) drawCrownTaken(sheet, crown, this.#inks)
    if (levels && ground) drawLevels(sheet, { levels, stray, width: ground.width }, this.#inks)
  }

  get #inks() {
    return this.shown().isPaper ? PAPER_INK : INK
  }

  #drawMarks(sheet: Sheet): void {
    const { ground, strokes, selection, fault } = this.shown()
    if (!ground) return
    const { traced, hovered } = this.sight()
    drawMarks(sheet, { strokes, skeleton: traced?.skeleton ?? null, selection, hovered, fault }, this.#inks)
  }

  #drawPen(sheet: Sheet): void {
    const { pen, aim } = this.sight()
    if (pen) drawPenLine(sheet, pen, this.#inks)
    if (aim) drawAim(sheet, aim, pen !== null)
  }
}
