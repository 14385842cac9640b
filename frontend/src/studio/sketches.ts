import type { StrokeSketch } from '../api/types'
import type { Extent } from '../sheets'
import { fromWire, type Line, onSheet, type SheetName, type Strokes, toWire, withSheet } from '../strokes'
import { text } from '../text'

/** One sheet's strokes and the size of that sheet, px. */
export interface SketchFile {
  readonly strokes: Strokes
  readonly size: Extent
  /** What was corrected while a picture of them was read, as sentences for the user. */
  readonly corrections?: string
}

/** A tree's strokes: over its photo, or on the sheets of sketches. */
export interface Drawn {
  readonly strokes: Strokes
  /** The sizes of the sketches' sheets, px; with a front's size, the tree is made of sketches. */
  readonly sizes?: Readonly<Partial<Record<SheetName, Extent>>>
  /** What was corrected while pictures of sketches were read, as sentences for the user. */
  readonly corrections?: string
}

/** Room around strokes on a sheet of unknown size, as a share of their height. */
const MARGIN = 0.08

/** Return one sheet's strokes and size in the form of sketch files and requests. */
export function sketchToWire(strokes: Strokes, sheet: SheetName, { width, height }: Extent): StrokeSketch {
  const { crown, branches = [] } = toWire(onSheet(strokes, sheet))
  return { canvas: [width, height], ...(crown && { crown }), branches }
}

/** Return what a sketch file holds; throws a TypeError where it has another form. */
export function sketchFrom(value: unknown): SketchFile {
  const { crown, branches } = fromWire(value)
  const strokes = { ...fromWire({}), crown, branches }
  const lines = [...(crown ? [crown] : []), ...branches.map(({ points }) => points)]
  return { strokes, size: sizeIn(value) ?? sizeAround(lines.flat()) }
}

/** Return the strokes of both sheets; a front without a size was drawn over a photo. */
export function pairSketches(front: Pick<SketchFile, 'strokes'> & Partial<SketchFile>, side: SketchFile | null): Drawn {
  const sizes = { ...(front.size && { front: front.size }), ...(side && { side: side.size }) }
  const strokes = side ? withSheet(front.strokes, 'side', side.strokes) : front.strokes
  const corrections = [correctionsOn('front', front), side && correctionsOn('side', side)].filter(Boolean).join(' ')
  return { strokes, sizes, ...(corrections && { corrections }) }
}

/** Return what was corrected on a sheet, as a sentence for the user; empty where nothing was. */
export function correctionsOn(sheet: SheetName, { corrections }: Partial<SketchFile>): string {
  return corrections ? text.sheets.remark(text.sheets[sheet], corrections) : ''
}

function sizeIn(value: unknown): Extent | null {
  const { canvas } = value as { canvas?: readonly unknown[] | null }
  const [width, height] = canvas ?? []
  return typeof width === 'number' && typeof height === 'number' && width > 0 && height > 0 ? { width, height } : null
}

function sizeAround(points: Line): Extent {
  const [right, bottom] = [0, 1].map(axis => Math.max(1, ...points.map(point => point[axis]!)))
  const margin = MARGIN * bottom!
  return { width: Math.ceil(right! + margin), height: Math.ceil(bottom! + margin) }
}
