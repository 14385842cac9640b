import type { TraceAnswer } from '../api/types'
import { doubtIn } from '../doubts'
import {
  brushWidth,
  commonLevels,
  differingLevels,
  drawnOn,
  type Extent,
  isPaper,
  type Levels,
  openSheets,
  photoDrawnOn,
  sheetOf,
} from '../sheets'
import type { Selection, Sheet, State, Tool } from '../state'
import type { Line, SheetName, StrokeRef, Strokes } from '../strokes'
import { tracedOn } from '../tracedOn'

/** The part of the page's state that one sheet shows. */
export interface SheetView {
  readonly sheet: Sheet | null
  /** Whether it is paper, perhaps over a picture; a photo whose tree is traced is not. */
  readonly isPaper: boolean
  readonly strokes: Strokes
  readonly selection: Selection | null
  /** The stroke at fault, or in doubt. */
  readonly fault: StrokeRef | null
  readonly tool: Tool
  /** The brush's width, sheet px; null for a pencil. */
  readonly brush: number | null
  /** What was traced in the photo. */
  readonly traced: TraceAnswer | null
  /** The crown that tracing assumed on paper where none was drawn. */
  readonly assumedCrown: Line | null
  /** Where the front's tree stands and ends, on this sheet; null over a photo without a side. */
  readonly levels: Levels | null
  /** Where the side's own tree stands and ends, if that is elsewhere. */
  readonly stray: Levels | null
}

/** Return what one sheet shows of the state. */
export function viewOf(state: State, name: SheetName): SheetView {
  const { selection, faults, traced } = state
  const [sheet, onPaper, photo] = [sheetOf(state, name), isPaper(state, name), photoDrawnOn(state)]
  const strokes = drawnOn(state, name)
  return {
    sheet,
    isPaper: onPaper,
    strokes,
    selection: toSheetSelection(selection, name, photo),
    fault: toSheetSelection(faults.strokes?.stroke ?? doubtIn(state)?.stroke ?? null, name, photo),
    tool: onPaper && state.tool === 'scale' ? 'select' : state.tool,
    brush: onPaper && sheet ? brushWidth(state, sheet) : null,
    traced: onPaper || !(strokes.crown || photo) ? null : tracedOn(state),
    assumedCrown: onPaper && !strokes.crown && strokes.branches.length ? (traced?.crowns?.[name] ?? null) : null,
    levels: state.sheets?.side || state.sheets?.source === 'sketch' ? commonLevels(state, name) : null,
    stray: name === 'side' ? differingLevels(state) : null,
  }
}

/** Return the area that a fitted sheet must show, sheet px: as wide as the widest sheet, so that all have one scale. */
export function extentOf(state: State, name: SheetName): Extent | null {
  const sheet = sheetOf(state, name)
  if (!sheet) return null
  const open = openSheets(state).map(other => sheetOf(state, other)!)
  const widths = open.map(({ width, height }) => (width / height) * sheet.height)
  return { width: Math.max(...widths), height: sheet.height }
}

/** Return what is selected on one sheet as the page's state names it; `photo` is the one that is drawn on, of many. */
export function toPageSelection<S extends Selection>(
  selection: S | null,
  sheet: SheetName,
  photo: string | null,
): S | null {
  if (!selection || selection.kind === 'traced') return selection
  if (photo !== null) return { ...selection, photo }
  return sheet === 'side' ? { ...selection, sheet } : selection
}

/** Return what the page's state selects as its sheet names it; null on another sheet, or over another photo of many. */
function toSheetSelection<S extends Selection>(
  selection: S | null,
  sheet: SheetName,
  drawnOver: string | null,
): S | null {
  if (!selection || selection.kind === 'traced') return sheet === 'front' ? selection : null
  const { sheet: own = 'front', photo = null, ...rest } = selection
  return own === sheet && photo === drawnOver ? (rest as S) : null
}
