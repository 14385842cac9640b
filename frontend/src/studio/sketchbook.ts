import { advance, type History, redo, undo } from '../history'
import type { Selection, Store, Tool } from '../state'
import { isEmpty, type Line, NO_STROKES, type StrokeKind, type Strokes, withoutStroke, withStroke } from '../strokes'
import { eraseLine } from '../tracedBranch'

/** Edits of the strokes; each can be undone. */
export class Sketchbook {
  constructor(private readonly store: Store) {}

  /** Take a finished stroke; after the crown the trunk is what comes next. */
  draw(kind: StrokeKind, points: Line): void {
    const first = kind === 'crown' && !this.store.strokes.crown
    this.#advance(withStroke(this.store.strokes, kind, points))
    if (first && this.store.state.tool === 'crown') this.store.set({ tool: 'branch' })
  }

  select(selection: Selection | null): void {
    this.store.set({ selection })
  }

  hold(tool: Tool): void {
    this.store.set({ tool, ...(tool !== 'select' && { selection: null }) })
  }

  /** Delete what is selected: a stroke, or a traced branch by a stroke that erases it. */
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

  #advance(strokes: Strokes): void {
    this.#set(advance(this.store.state.history, strokes))
  }

  #set(history: History<Strokes>): void {
    this.store.set({ history, selection: null })
    this.store.fault('strokes', null)
  }
}
