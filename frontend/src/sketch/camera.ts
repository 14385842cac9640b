import type { Point } from '../strokes'
import {
  centreView,
  clampView,
  type Frame,
  fitView,
  panBy,
  panIntoView,
  type Size,
  toSheet,
  type View,
  zoomAbout,
} from './viewport'

/** How far inside the window the keyboard's cursor is kept, CSS px. */
const CURSOR_MARGIN = 40
const EMPTY: Size = { width: 0, height: 0 }

/** Holds which part of the sheet the window shows, and calls `onChange` with each new view. */
export class Camera {
  #view: View = { scale: 1, x: 0, y: 0 }
  #frame: Frame = { sheet: EMPTY, window: EMPTY }
  /** The area whose size sets the scale of a fitted sheet, sheet px. */
  #extent = EMPTY
  #fitted = true

  constructor(private readonly onChange: (view: View) => void) {}

  get view(): View {
    return this.#view
  }

  /** Show another sheet, whole, at the scale that an area of size `extent` (sheet px) needs. */
  open(sheet: Size, extent = sheet): void {
    this.#frame = { ...this.#frame, sheet }
    this.#extent = extent
    this.fit()
  }

  /** Change the area that sets the fitted scale (sheet px); a fitted sheet is fitted again. */
  setExtent(extent: Size): void {
    this.#extent = extent
    if (this.#fitted) this.fit()
  }

  /** Take over the scale and vertical offset (CSS px) of another sheet's camera; `whole` if that one is fitted. */
  follow({ scale, y }: Pick<View, 'scale' | 'y'>, whole: boolean): void {
    if (!this.#ready || (nearlyEqual(scale, this.#view.scale) && nearlyEqual(y, this.#view.y))) return
    const { sheet, window } = this.#frame
    const [across] = whole ? [sheet.width / 2] : toSheet(this.#view, [window.width / 2, 0])
    this.#setView({ scale, x: window.width / 2 - across * scale, y }, whole)
  }

  /** Whether the whole sheet is shown, and will be when the window or the extent changes. */
  get isWhole(): boolean {
    return this.#fitted
  }

  /** Set the window's size, CSS px; a fitted sheet is fitted again, any other keeps its middle. */
  resize(window: Size): void {
    const { width, height } = this.#frame.window
    const middle = toSheet(this.#view, [width / 2, height / 2])
    this.#frame = { ...this.#frame, window }
    if (this.#fitted || width === 0) this.fit()
    else this.#setView(centreView(this.#view.scale, middle, this.#frame))
  }

  /** Show the whole sheet. */
  fit(): void {
    if (!this.#ready) return
    const { sheet, window } = this.#frame
    const { scale } = fitView({ sheet: this.#extent, window })
    this.#setView(centreView(scale, [sheet.width / 2, sheet.height / 2], this.#frame), true)
  }

  /** Show one sheet px as one CSS px. */
  actual(): void {
    this.zoom(1 / this.#view.scale)
  }

  /** Scale by a factor about a point of the window (CSS px), its middle where none is given. */
  zoom(factor: number, about?: Point): void {
    if (!this.#ready) return
    const { width, height } = this.#frame.window
    this.#setView(zoomAbout(this.#view, factor, about ?? [width / 2, height / 2], this.#frame))
  }

  /** Move the sheet by an offset, CSS px. */
  pan(by: Point): void {
    if (this.#ready) this.#setView(panBy(this.#view, by))
  }

  /** Bring a point of the sheet into the window. */
  show(point: Point): void {
    const view = panIntoView(this.#view, point, CURSOR_MARGIN, this.#frame)
    if (view.x !== this.#view.x || view.y !== this.#view.y) this.#setView(view)
  }

  get #ready(): boolean {
    const { sheet, window } = this.#frame
    return Math.min(sheet.width, sheet.height, window.width, window.height) > 0
  }

  #setView(view: View, fitted = false): void {
    this.#fitted = fitted
    this.#view = clampView(view, this.#frame)
    this.onChange(this.#view)
  }
}

function nearlyEqual(one: number, other: number): boolean {
  return Math.abs(one - other) <= 1e-6 * Math.max(1, Math.abs(one))
}
