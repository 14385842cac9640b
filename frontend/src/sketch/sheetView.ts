import type { TraceAnswer } from '../api/types'
import { doubtIn } from '../doubts'
import {
  brushWidth,
  commonLevels,
  type Extent,
  isPaper,
  type Levels,
  openSheets,
  sheetOf,
  strayLevels,
} from '../sheets'
import type { Selection, Sheet, State, Tool } from '../state'
import { type Line, onSheet, type SheetName, type StrokeRef, type Strokes } from '../strokes'

/** What one sheet shows of the page's state, as if there were no other. */
export interface SheetView {
  readonly sheet: Sheet | null
  /** White paper, or tracing paper over a picture; the photo of a tree that is traced is not paper. */
  readonly isPaper: boolean
  readonly strokes: Strokes
  readonly selection: Selection | null
  /** The stroke at fault, or in doubt. */
  readonly fault: StrokeRef | null
  readonly tool: Tool
  /** How wide branches are drawn, px; null where the tool says nothing of it. */
  readonly brush: number | null
  /** What was traced in the photo. */
  readonly traced: TraceAnswer | null
  /** The crown that was taken on paper where none was drawn. */
  readonly crown: Line | null
  /** Where the tree stands and ends, by the front's sheet; null where one sheet stands alone. */
  readonly levels: Levels | null
  /** And by the side's own strokes, where that is elsewhere. */
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
    selection: local(selection, name),
    fault: local(faults.strokes?.stroke ?? doubtIn(state)?.stroke ?? null, name),
    tool: onPaper && state.tool === 'scale' ? 'select' : state.tool,
    brush: onPaper && sheet ? brushWidth(state, sheet) : null,
    traced: onPaper || !strokes.crown ? null : (traced?.answer ?? null),
    crown: onPaper && !strokes.crown && strokes.branches.length ? (traced?.crowns?.[name] ?? null) : null,
    levels: state.sheets?.side || state.sheets?.source === 'sketch' ? commonLevels(state, name) : null,
    stray: name === 'side' ? strayLevels(state) : null,
  }
}

/** What is to be seen whole on a sheet, px of it: as wide as the widest, so that all are seen at one scale. */
export function extentOf(state: State, name: SheetName): Extent | null {
  const sheet = sheetOf(state, name)
  if (!sheet) return null
  const open = openSheets(state).map(other => sheetOf(state, other)!)
  const widths = open.map(({ width, height }) => (width / height) * sheet.height)
  return { width: Math.max(...widths), height: sheet.height }
}

/** Name something of one sheet for all of the page. */
export function ofSheet<S extends Selection>(selection: S | null, sheet: SheetName): S | null {
  return selection && sheet === 'side' && selection.kind !== 'traced' ? { ...selection, sheet } : selection
}

/** Return what is selected as its own sheet names it; null on other sheets. */
function local<S extends Selection>(selection: S | null, sheet: SheetName): S | null {
  if (!selection || selection.kind === 'traced') return sheet === 'front' ? selection : null
  const { sheet: own = 'front', ...rest } = selection
  return own === sheet ? (rest as S) : null
}
