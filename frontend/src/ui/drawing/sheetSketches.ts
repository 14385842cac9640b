import { isPaper, sheetOf } from '../../sheets'
import { Sketch } from '../../sketch/sketch'
import type { SketchEvents } from '../../sketch/sketchEvents'
import type { View } from '../../sketch/viewport'
import type { SheetName } from '../../strokes'
import type { Studio } from '../../studio/studio'
import { text } from '../../text'
import { announcePen } from './announcements'

/** Where each sheet lies in its window. */
export type Views = Readonly<Partial<Record<SheetName, View>>>

/** What can be done to the view of the sheets. */
export interface Zoom {
  fit(): void
  actual(): void
  zoom(factor: number): void
}

/** The sketches on both sheets: each looks where the other does, and the zoom is that of the active one. */
export class SheetSketches implements Zoom {
  readonly #sketches: Partial<Record<SheetName, Sketch>> = {}

  constructor(
    private readonly studio: Studio,
    private readonly looked: (name: SheetName, view: View) => void,
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

  /** Name a sheet by what it is now: a photo or paper. */
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
      looked: (view, whole) => this.#look(name, view, whole),
      said: ({ pen, at }) => announcePen(store, pen, at, sheetOf(store.state, name)!),
    }
  }

  #look(name: SheetName, view: View, whole: boolean): void {
    this.looked(name, view)
    const { state } = this.studio.store
    const other = name === 'front' ? 'side' : 'front'
    const [own, its] = [sheetOf(state, name), sheetOf(state, other)]
    if (own && its) this.#sketches[other]?.follow({ scale: (view.scale * own.height) / its.height, y: view.y }, whole)
  }
}
