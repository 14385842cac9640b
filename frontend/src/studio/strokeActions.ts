import { advance, type History, redo, undo } from '../history'
import { brushWidth, isDrawn, isPaper, paper, sheetOf } from '../sheets'
import type { Selection, Store, Tool } from '../state'
import {
  isEmpty,
  type Line,
  NO_STROKES,
  onSheet,
  type SheetName,
  type StrokeKind,
  type Strokes,
  withoutStroke,
  withScale,
  withSheet,
  withStroke,
} from '../strokes'
import { eraseLine } from '../tracedBranch'
import { metresOf } from './scaling'

const SCALE: Selection = { kind: 'scale', index: 0 }

/** Edits the strokes; each edit can be undone. */
export class StrokeActions {
  constructor(private readonly store: Store) {}

  /** Add a finished stroke; after the first crown, the branch tool is chosen for the trunk. */
  draw(kind: StrokeKind, points: Line, sheet: SheetName = 'front'): void {
    if (kind === 'scale') {
      this.#setScale(points)
      return
    }
    const own = onSheet(this.store.strokes, sheet)
    const first = kind === 'crown' && !own.crown
    this.#advance(withSheet(this.store.strokes, sheet, withStroke(own, kind, points, this.#brush(sheet))))
    if (first && this.store.state.tool === 'crown') this.store.set({ tool: 'branch' })
  }

  /** Set the measured line's length, metres. */
  measure(metres: number): void {
    const { scale } = this.store.strokes
    if (!scale || scale.metres === metres) return
    this.#advance(withScale(this.store.strokes, scale.points, metres), SCALE)
  }

  select(selection: Selection | null): void {
    this.store.set({ selection })
  }

  /** Choose a tool. */
  chooseTool(tool: Tool): void {
    this.store.set({ tool, ...(tool !== 'select' && { selection: null }) })
  }

  /** Delete what is selected: a stroke, or a traced branch, by an erase stroke across it. */
  remove(): void {
    const { selection, traced } = this.store.state
    if (!selection) return
    if (selection.kind !== 'traced') this.#advance(withoutStroke(this.store.strokes, selection))
    else if (traced) this.draw('erase', eraseLine(traced.answer.skeleton, selection.joint))
  }

  clear(): void {
    if (!isEmpty(this.store.strokes)) this.#advance(NO_STROKES)
  }

  undo(): void {
    this.#set(undo(this.store.state.history))
  }

  redo(): void {
    this.#set(redo(this.store.state.history))
  }

  /** Return the brush's width on a sheet, px; null for a pencil and over a photo, which shows thickness itself. */
  #brush(sheet: SheetName): number | null {
    const { state } = this.store
    const drawnOn = sheetOf(state, sheet)
    return drawnOn && isPaper(state, sheet) ? brushWidth(state, drawnOn) : null
  }

  /** Set the measured line; it keeps its length where one end was moved, otherwise the length is guessed. */
  #setScale(points: Line): void {
    const { scale } = this.store.strokes
    const moved = scale?.points.some(end => points.includes(end))
    const metres = scale && moved ? scale.metres : metresOf(points, this.store.state)
    this.#advance(withScale(this.store.strokes, points, metres), SCALE)
  }

  #advance(strokes: Strokes, selection: Selection | null = null): void {
    this.#set(advance(this.store.state.history, strokes), selection)
  }

  #set(history: History<Strokes>, selection: Selection | null = null): void {
    const { sheets } = this.store.state
    // Strokes of the side that come back need their sheet, which was closed.
    const reopened = sheets && !sheets.side && isDrawn(history.present, 'side')
    const side = reopened ? paper(sheets.front.height) : null
    this.store.set({ history, selection, ...(side && { sheets: { ...sheets!, side } }) })
    this.store.fault('strokes', null)
  }
}
