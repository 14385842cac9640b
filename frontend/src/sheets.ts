import { frameUrl } from './api/addresses'
import type { CapturePhoto } from './api/types'
import type { Capture, CaptureSheet, Clip, FrameSheet, PhotoSheet, Sheet, Sheets, State } from './state'
import {
  type Line,
  lineOf,
  onPhoto,
  onSheet,
  type Point,
  type SheetName,
  type Side,
  type Strokes,
  strokeRefs,
  withPhoto,
  withSheet,
} from './strokes'

type Open = Pick<State, 'sheets'>

export const SHEET_NAMES = ['front', 'side'] as const

/** The heights of a tree's root and top on its sheet, px from the sheet's top. */
export interface Levels {
  readonly root: number
  readonly top: number
}

/** A sheet's size, px. */
export interface Extent {
  readonly width: number
  readonly height: number
}

/** The size of a new sheet of paper, px. */
const PAPER: Extent = { width: 900, height: 1200 }
/** Where a tree is expected on an empty sheet, as shares of the sheet's height. */
const EXPECTED: Levels = { root: 0.92, top: 0.08 }
/** How far the side's levels may differ from the front's unmentioned, as a share of the tree's height. */
const TOLERANCE = 0.04

/** Return a sheet of white paper, as high as another one where a height is given. */
export function paper(height = PAPER.height): Sheet {
  return sheetOfSize({ width: Math.round((PAPER.width / PAPER.height) * height), height })
}

/** Return a sheet of white paper of a size, px. */
export function sheetOfSize({ width, height }: Extent): Sheet {
  return { id: null, width, height, file: null, url: null }
}

/** Return whether a sheet has a photo that the service has. */
export function hasPhoto(sheet: Sheet): sheet is PhotoSheet {
  return sheet.id !== null && sheet.file !== null && sheet.url !== null
}

/** Return a sheet by its name; null where it is not open. */
export function sheetOf({ sheets }: Open, name: SheetName): Sheet | null {
  return sheets?.[name] ?? null
}

/** Return whether a sheet is paper to sketch on; a photo whose tree is traced is not. */
export function isPaper({ sheets }: Open, name: SheetName): boolean {
  return sheets?.source === 'sketch' || name === 'side'
}

/** Return the sheet of a photo of many. */
export function captureSheet({ id, name, width, height, image }: CapturePhoto): CaptureSheet {
  return { id, name, width, height, file: null, url: image }
}

/** Return the many photos that are open; null where the tree has another source. */
export function captureOf({ sheets }: Open): Capture | null {
  return sheets?.source === 'capture' ? sheets.capture : null
}

/** Return the sheet of a clip's frame. */
export function frameSheet({ id, width, height }: Clip, frame: number): FrameSheet {
  return { id, width, height, file: null, url: id && frameUrl(id, frame), frame }
}

/** Return the clip that is open; null where the tree has another source. */
export function clipOf({ sheets }: Open): Clip | null {
  return sheets?.source === 'clip' ? sheets.clip : null
}

/** Return the name of the photo of many that is drawn on; null where the tree has another source. */
export function photoDrawnOn({ sheets }: Open): string | null {
  return sheets?.source === 'capture' ? sheets.front.name : null
}

/** Return what is drawn on an open sheet: on the front of many photos, over the photo that is drawn on now. */
export function drawnOn(state: Open & Pick<State, 'history'>, name: SheetName): Strokes {
  const photo = photoDrawnOn(state)
  return photo === null ? onSheet(state.history.present, name) : onPhoto(state.history.present, photo)
}

/** Return all strokes with those of an open sheet replaced. */
export function withDrawn(state: Open & Pick<State, 'history'>, name: SheetName, strokes: Strokes): Strokes {
  const photo = photoDrawnOn(state)
  const all = state.history.present
  return photo === null ? withSheet(all, name, strokes) : withPhoto(all, photo, strokes)
}

/** Return the sheets with one of them replaced; a photo's front is only replaced by another photo. */
export function replaceSheet(sheets: Sheets, name: SheetName, sheet: Sheet): Sheets {
  if (sheets.source === 'capture' || sheets.source === 'clip') return sheets
  if (name === 'side') return { ...sheets, side: sheet }
  if (sheets.source === 'sketch') return { ...sheets, front: sheet }
  return hasPhoto(sheet) ? { ...sheets, front: sheet } : sheets
}

/** Return the brush's width on a sheet, px; null for a pencil. */
export function brushWidth({ brush }: Pick<State, 'brush'>, { height }: Extent): number | null {
  return brush === null ? null : Math.round(brush * height * 10) / 10
}

/** Return the names of the open sheets. */
export function openSheets({ sheets }: Open): readonly SheetName[] {
  return SHEET_NAMES.filter(name => sheets?.[name])
}

/** Return the heights of a sketched tree's root and top; null before its first branch. */
export function levelsOf({ branches }: Side): Levels | null {
  const [trunk] = branches
  if (!trunk) return null
  const down = (line: Line) => line.map(([, y]) => y)
  return { root: Math.max(...down(trunk.points)), top: Math.min(...branches.flatMap(({ points }) => down(points))) }
}

/** Return the front's levels, or those of an expected tree, converted to px of one of the sheets. */
export function commonLevels(state: Open & Pick<State, 'history'>, sheet: SheetName): Levels | null {
  const [front, shown] = [sheetOf(state, 'front'), sheetOf(state, sheet)]
  if (!front || !shown) return null
  const { root, top } = levelsOf(state.history.present) ?? scaled(EXPECTED, front.height)
  return scaled({ root, top }, shown.height / front.height)
}

/** Return the side's own levels if they differ from the front's, to which its drawing will be scaled; else null. */
export function differingLevels(state: Open & Pick<State, 'history'>): Levels | null {
  const common = commonLevels(state, 'side')
  const own = levelsOf(onSheet(state.history.present, 'side'))
  if (!common || !own) return null
  const apart = Math.max(Math.abs(own.root - common.root), Math.abs(own.top - common.top))
  return apart > TOLERANCE * (common.root - common.top) ? own : null
}

/** Return a drawing fitted to a sheet of another size: as large as fits there, in the middle. */
export function fittedTo<S extends Side>(drawn: S, from: Extent, to: Extent): S {
  const factor = Math.min(to.width / from.width, to.height / from.height)
  const [left, above] = [(to.width - factor * from.width) / 2, (to.height - factor * from.height) / 2]
  const move = ([x, y]: Point): Point => [left + factor * x, above + factor * y]
  const branches = drawn.branches.map(({ points, width }) => ({
    points: points.map(move),
    ...(width !== undefined && { width: factor * width }),
  }))
  return { ...drawn, crown: drawn.crown?.map(move) ?? null, branches }
}

/** Return whether there are strokes on a sheet. */
export function isDrawn(strokes: Strokes, sheet: SheetName): boolean {
  const own = onSheet(strokes, sheet)
  return strokeRefs(own).some(ref => lineOf(own, ref).length > 0)
}

function scaled({ root, top }: Levels, factor: number): Levels {
  return { root: root * factor, top: top * factor }
}
