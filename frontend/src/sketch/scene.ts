import type { Selection, State, TraceAnswer } from '../state'
import type { Point } from '../strokes'
import { Layers } from './layers'
import { drawAim, drawMarks, drawPenLine, drawTraced, type Sheet } from './overlay'
import type { PenLine } from './penLine'
import { PhotoLayer } from './photoLayer'
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
    private readonly state: () => State,
  ) {
    const paint = {
      photo: (sheet: Sheet) => this.picture.draw(sheet),
      traced: (sheet: Sheet) => this.#drawTraced(sheet),
      strokes: (sheet: Sheet) => this.#drawMarks(sheet),
      pen: (sheet: Sheet) => this.#drawPen(sheet),
    }
    this.layers = new Layers(host, paint, () => sight().view)
  }

  #drawTraced(sheet: Sheet): void {
    const { traced } = this.sight()
    if (traced && this.state().photo) drawTraced(sheet, traced)
  }

  #drawMarks(sheet: Sheet): void {
    const { photo, history, selection, faults } = this.state()
    if (!photo) return
    const { traced, hovered } = this.sight()
    const [skeleton, fault] = [traced?.skeleton ?? null, faults.strokes?.stroke ?? null]
    drawMarks(sheet, { strokes: history.present, skeleton, selection, hovered, fault })
  }

  #drawPen(sheet: Sheet): void {
    const { pen, aim } = this.sight()
    if (pen) drawPenLine(sheet, pen.points, pen.kind)
    if (aim) drawAim(sheet, aim, pen !== null)
  }
}
