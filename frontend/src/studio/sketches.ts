import type { StrokeSketch } from '../api/types'
import type { Extent } from '../sheets'
import { fromWire, type Line, onSheet, type SheetName, type Strokes, toWire, withSheet } from '../strokes'
import { text } from '../text'

/** One sheet's strokes, and how large a sheet they were drawn on. */
export interface SketchFile {
  readonly strokes: Strokes
  readonly size: Extent
  /** What was corrected in a picture of them, in sentences for the user. */
  readonly corrections?: string
}

/** What is drawn of a tree: over its photo, or on sheets. */
export interface Drawn {
  readonly strokes: Strokes
  /** The sizes of the sheets that sketches were drawn on; the front's makes the tree one of sketches. */
  readonly sizes?: Readonly<Partial<Record<SheetName, Extent>>>
  /** What was corrected in pictures of sketches, in sentences for the user. */
  readonly corrections?: string
}

/** Room around strokes whose sheet is not known, as a share of their height. */
const MARGIN = 0.08

/** Write one sheet's strokes as sketch files and the service have them, with the size of what they were drawn on. */
export function sketchToWire(strokes: Strokes, sheet: SheetName, { width, height }: Extent): StrokeSketch {
  const { crown, branches = [] } = toWire(onSheet(strokes, sheet))
  return { canvas: [width, height], ...(crown && { crown }), branches }
}

/** Read a sketch file, or throw a TypeError where it has another form. */
export function sketchFrom(value: unknown): SketchFile {
  const { crown, branches } = fromWire(value)
  const strokes = { ...fromWire({}), crown, branches }
  const lines = [...(crown ? [crown] : []), ...branches.map(({ points }) => points)]
  return { strokes, size: canvasOf(value) ?? around(lines.flat()) }
}

/** Put the left side beside the front, which is no sketch where its size is not given. */
export function paired(front: Pick<SketchFile, 'strokes'> & Partial<SketchFile>, side: SketchFile | null): Drawn {
  const sizes = { ...(front.size && { front: front.size }), ...(side && { side: side.size }) }
  const strokes = side ? withSheet(front.strokes, 'side', side.strokes) : front.strokes
  const corrections = [correctionsOn('front', front), side && correctionsOn('side', side)].filter(Boolean).join(' ')
  return { strokes, sizes, ...(corrections && { corrections }) }
}

/** Return what was corrected on a sheet, as a sentence. */
export function correctionsOn(sheet: SheetName, { corrections }: Partial<SketchFile>): string {
  return corrections ? text.sheets.remark(text.sheets[sheet], corrections) : ''
}

function canvasOf(value: unknown): Extent | null {
  const { canvas } = value as { canvas?: readonly unknown[] | null }
  const [width, height] = canvas ?? []
  return typeof width === 'number' && typeof height === 'number' && width > 0 && height > 0 ? { width, height } : null
}

function around(points: Line): Extent {
  const [right, bottom] = [0, 1].map(axis => Math.max(1, ...points.map(point => point[axis]!)))
  const margin = MARGIN * bottom!
  return { width: Math.ceil(right! + margin), height: Math.ceil(bottom! + margin) }
}
