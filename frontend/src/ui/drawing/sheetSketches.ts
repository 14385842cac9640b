import { isPaper, sheetOf } from '../../sheets'
import { Sketch } from '../../sketch/sketch'
import type { SketchEvents } from '../../sketch/sketchEvents'
import type { View } from '../../sketch/viewport'
import type { SheetName } from '../../strokes'
import type { Studio } from '../../studio/studio'
import { text } from '../../text'
import { announcePen } from './announcements'

/** The view of each sheet. */
export type Views = Readonly<Partial<Record<SheetName, View>>>

/** How the view of the active sheet can be changed. */
export interface Zoom {
  fit(): void
  actual(): void
  zoom(factor: number): void
}

/** The sketches of both sheets: when one is moved or zoomed, the other follows. */
export class SheetSketches implements Zoom {
  readonly #sketches: Partial<Record<SheetName, Sketch>> = {}

  constructor(
    private readonly studio: Studio,
    private readonly viewed: (name: SheetName, view: View) => void,
  ) {}

  /** Make the sketch of a sheet in `host`; the call ends it. */
  add(name: SheetName, host: HTMLElement): () => void {
    const sketch = new Sketch(host, this.studio.store, this.#events(name), name)
    this.#sketches[name] = sketch
    return () => {
      delete this.#sketches[name]
      sketch.end()
    }
  }

  /** Label a sheet for screen readers by what it is now: a photo or paper. */
  label(name: SheetName): void {
    const { workspace, sheets } = text
    const onPaper = isPaper(this.studio.store.state, name)
    this.#sketches[name]?.name({
      canvas: onPaper ? sheets.canvas[name] : workspace.canvas,
      keys: onPaper ? sheets.canvasKeys : workspace.canvasKeys,
    })
  }

  focus(name: SheetName): void {
    this.#sketches[name]?.focus()
  }

  fit(): void {
    this.#active?.fit()
  }

  actual(): void {
    this.#active?.actual()
  }

  zoom(factor: number): void {
    this.#active?.zoom(factor)
  }

  get #active(): Sketch | undefined {
    return this.#sketches[this.studio.store.state.active]
  }

  #events(name: SheetName): SketchEvents {
    const { store, strokes, sheets } = this.studio
    return {
      touched: () => sheets.activate(name),
      drew: (kind, points) => strokes.draw(kind, points, name),
      selected: selection => strokes.select(selection),
      remove: () => strokes.remove(),
      looked: (view, whole) => this.#view(name, view, whole),
      said: ({ pen, at }) => announcePen(store, pen, at, sheetOf(store.state, name)!),
    }
  }

  #view(name: SheetName, view: View, whole: boolean): void {
    this.viewed(name, view)
    const { state } = this.studio.store
    const other = name === 'front' ? 'side' : 'front'
    const [own, its] = [sheetOf(state, name), sheetOf(state, other)]
    if (own && its) this.#sketches[other]?.follow({ scale: (view.scale * own.height) / its.height, y: view.y }, whole)
  }
}
