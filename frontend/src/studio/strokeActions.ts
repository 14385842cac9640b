import type { Edit } from '../edits'
import { advance, type History, redo, undo } from '../history'
import { brushWidth, drawnOn, isDrawn, isPaper, paper, photoDrawnOn, replaceSheet, sheetOf, withDrawn } from '../sheets'
import type { Selection, Store, Tool, Traced } from '../state'
import {
  cleared,
  isEmpty,
  type Line,
  type PhotoDistance,
  type SheetName,
  type StrokeKind,
  type StrokeRef,
  type Strokes,
  withDistance,
  withEdit,
  withFrame,
  withoutStroke,
  withScale,
  withStroke,
} from '../strokes'
import { eraseLine } from '../tracedBranch'
import { isOfPhotos } from '../tracedOn'
import { metresOf } from './scaling'

const SCALE: StrokeRef = { kind: 'scale', index: 0 }

/** Edits the strokes; each edit can be undone. */
export class StrokeActions {
  constructor(private readonly store: Store) {}

  /** Add a finished stroke; after the first crown, the branch tool is chosen for the trunk. */
  draw(kind: StrokeKind, points: Line, sheet: SheetName = 'front'): void {
    if (kind === 'scale') {
      this.#setScale(points)
      return
    }
    const own = drawnOn(this.store.state, sheet)
    const first = kind === 'crown' && !own.crown
    this.#advance(withDrawn(this.store.state, sheet, withStroke(own, kind, points, this.#brush(sheet))))
    if (first && this.store.state.tool === 'crown') this.store.set({ tool: 'branch' })
  }

  /** Set the measured line's length, metres. */
  measure(metres: number): void {
    const { scale } = this.store.strokes
    if (scale && scale.metres !== metres) this.#advanceScale(scale.points, metres)
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
    else if (traced) this.#removeTraced(traced.answer, selection.joint)
  }

  /** Edit the branches that many photos show. */
  edit(edit: Edit): void {
    this.#advance(withEdit(this.store.strokes, edit))
  }

  /** Set how far apart two photos of many were taken, which gives the tree its scale; null: its height does. */
  setDistance(distance: PhotoDistance | null): void {
    this.#advance(withDistance(this.store.strokes, distance))
  }

  /** Draw over another frame of the clip, from 0; the strokes stay. */
  chooseFrame(frame: number): void {
    if (frame !== this.store.strokes.frame) this.#advance(withFrame(this.store.strokes, frame))
  }

  clear(): void {
    if (!isEmpty(this.store.strokes)) this.#advance(cleared(this.store.strokes))
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

  /** Remove a traced branch by its first joint: of a photo by an erase stroke across it, of many by an edit. */
  #removeTraced(answer: Traced['answer'], joint: number): void {
    if (!isOfPhotos(answer)) this.draw('erase', eraseLine(answer.skeleton, joint))
    else this.edit({ do: 'remove', at: answer.skeleton.points[joint]! })
  }

  /** Set the measured line; it keeps its length where one end was moved, otherwise the length is guessed. */
  #setScale(points: Line): void {
    const { scale } = this.store.strokes
    const moved = scale?.points.some(end => points.includes(end))
    const metres = scale && moved ? scale.metres : metresOf(points, this.store.state)
    this.#advanceScale(points, metres)
  }

  #advanceScale(points: Line, metres: number): void {
    const { state } = this.store
    const photo = photoDrawnOn(state)
    const drawn = withScale(drawnOn(state, 'front'), points, metres)
    this.#advance(withDrawn(state, 'front', drawn), { ...SCALE, ...(photo !== null && { photo }) })
  }

  #advance(strokes: Strokes, selection: Selection | null = null): void {
    this.#set(advance(this.store.state.history, strokes), selection)
  }

  #set(history: History<Strokes>, selection: Selection | null = null): void {
    const { sheets } = this.store.state
    // Strokes of the side that come back need their sheet, which was closed.
    const reopened = sheets && !sheets.side && isDrawn(history.present, 'side')
    const opened = reopened ? replaceSheet(sheets, 'side', paper(sheets.front.height)) : null
    this.store.set({ history, selection, ...(opened && { sheets: opened }) })
    this.store.fault('strokes', null)
  }
}
