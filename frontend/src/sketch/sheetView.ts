import type { TraceAnswer } from '../api/types'
import { doubtIn } from '../doubts'
import {
  brushWidth,
  commonLevels,
  differingLevels,
  type Extent,
  isPaper,
  type Levels,
  openSheets,
  sheetOf,
} from '../sheets'
import type { Selection, Sheet, State, Tool } from '../state'
import { type Line, onSheet, type SheetName, type StrokeRef, type Strokes } from '../strokes'

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
  const { history, selection, faults, traced } = state
  const [sheet, onPaper] = [sheetOf(state, name), isPaper(state, name)]
  const strokes = onSheet(history.present, name)
  return {
    sheet,
    isPaper: onPaper,
    strokes,
    selection: toSheetSelection(selection, name),
    fault: toSheetSelection(faults.strokes?.stroke ?? doubtIn(state)?.stroke ?? null, name),
    tool: onPaper && state.tool === 'scale' ? 'select' : state.tool,
    brush: onPaper && sheet ? brushWidth(state, sheet) : null,
    traced: onPaper || !strokes.crown ? null : (traced?.answer ?? null),
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

/** Return what is selected on one sheet as the page's state names it. */
export function toPageSelection<S extends Selection>(selection: S | null, sheet: SheetName): S | null {
  return selection && sheet === 'side' && selection.kind !== 'traced' ? { ...selection, sheet } : selection
}

/** Return what the page's state selects as its sheet names it; null on the other sheet. */
function toSheetSelection<S extends Selection>(selection: S | null, sheet: SheetName): S | null {
  if (!selection || selection.kind === 'traced') return sheet === 'front' ? selection : null
  const { sheet: own = 'front', ...rest } = selection
  return own === sheet ? (rest as S) : null
}
