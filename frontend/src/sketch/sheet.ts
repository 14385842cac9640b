import { doubtIn } from '../doubts'
import { brushWidth, commonLevels, type Extent, groundOf, isPaper, type Levels, strayLevels } from '../sheets'
import type { Ground, Selection, State, Tool, TraceAnswer } from '../state'
import { type Line, onSheet, type SheetName, type StrokeRef, type Strokes } from '../strokes'

/** What one sheet shows of the page's state, as if there were no other. */
export interface SheetSight {
  readonly ground: Ground | null
  /** White paper, or tracing paper over a picture; a photo of a tree that is traced is none. */
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

/** See one sheet of the state. */
export function sightOf(state: State, sheet: SheetName): SheetSight {
  const { history, selection, faults, traced } = state
  const [ground, onPaper] = [groundOf(state, sheet), isPaper(state, sheet)]
  const strokes = onSheet(history.present, sheet)
  return {
    ground,
    isPaper: onPaper,
    strokes,
    selection: local(selection, sheet),
    fault: local(faults.strokes?.stroke ?? doubtIn(state)?.stroke ?? null, sheet),
    tool: onPaper && state.tool === 'scale' ? 'select' : state.tool,
    brush: onPaper && ground ? brushWidth(state, ground) : null,
    traced: onPaper || !strokes.crown ? null : (traced?.answer ?? null),
    crown: onPaper && !strokes.crown && strokes.branches.length ? (traced?.crowns?.[sheet] ?? null) : null,
    levels: state.side || state.source === 'sketch' ? commonLevels(state, sheet) : null,
    stray: sheet === 'side' ? strayLevels(state) : null,
  }
}

/** What is to be seen whole on a sheet, px of it: as wide as the widest, so that all are seen at one scale. */
export function extentOf(state: State, sheet: SheetName): Extent | null {
  const ground = groundOf(state, sheet)
  if (!ground) return null
  const grounds = [state.photo, state.side].filter(one => one !== null)
  const widths = grounds.map(({ width, height }) => (width / height) * ground.height)
  return { width: Math.max(...widths), height: ground.height }
}

/** Name something of one sheet for all of the page. */
export function ofSheet<S extends Selection>(selection: S | null, sheet: SheetName): S | null {
  return selection && sheet === 'side' && selection.kind !== 'traced' ? { ...selection, sheet } : selection
}

/** Give what is selected as its own sheet names it; null on other sheets. */
function local<S extends Selection>(selection: S | null, sheet: SheetName): S | null {
  if (!selection || selection.kind === 'traced') return sheet === 'front' ? selection : null
  const { sheet: own = 'front', ...rest } = selection
  return own === sheet ? (rest as S) : null
}
