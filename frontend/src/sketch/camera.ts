import type { Point } from '../strokes'
import {
  centred,
  clampView,
  type Frame,
  fitted,
  panBy,
  type Size,
  showing,
  toPhoto,
  type View,
  zoomAbout,
} from './viewport'

/** How far inside the window the keyboard's pen is kept, CSS px. */
const LEEWAY = 40
const NOWHERE: Size = { width: 0, height: 0 }

/** Looks at the photo through the window; tells when it sees it otherwise. */
export class Camera {
  #view: View = { scale: 1, x: 0, y: 0 }
  #frame: Frame = { photo: NOWHERE, window: NOWHERE }
  /** What is to be seen whole, photo px. */
  #extent = NOWHERE
  #fitted = true

  constructor(private readonly changed: (view: View) => void) {}

  get view(): View {
    return this.#view
  }

  /** Look at another photo, the whole of it, at a scale that shows as much as `extent`. */
  open(photo: Size, extent = photo): void {
    this.#frame = { ...this.#frame, photo }
    this.#extent = extent
    this.fit()
  }

  /** Show the whole photo at the scale of another extent, if the whole was in sight. */
  reach(extent: Size): void {
    this.#extent = extent
    if (this.#fitted) this.fit()
  }

  /** Look as high up, and at the scale, that another camera does: `whole` if it shows the whole. */
  follow({ scale, y }: Pick<View, 'scale' | 'y'>, whole: boolean): void {
    if (!this.#ready || (alike(scale, this.#view.scale) && alike(y, this.#view.y))) return
    const { photo, window } = this.#frame
    const [across] = whole ? [photo.width / 2] : toPhoto(this.#view, [window.width / 2, 0])
    this.#look({ scale, x: window.width / 2 - across * scale, y }, whole)
  }

  /** Whether the whole photo is in sight, and is to stay so. */
  get isWhole(): boolean {
    return this.#fitted
  }

  /** Keep the middle where it is, or the whole photo in sight if it was. */
  resize(window: Size): void {
    const { width, height } = this.#frame.window
    const middle = toPhoto(this.#view, [width / 2, height / 2])
    this.#frame = { ...this.#frame, window }
    if (this.#fitted || width === 0) this.fit()
    else this.#look(centred(this.#view.scale, middle, this.#frame))
  }

  fit(): void {
    if (!this.#ready) return
    const { photo, window } = this.#frame
    const { scale } = fitted({ photo: this.#extent, window })
    this.#look(centred(scale, [photo.width / 2, photo.height / 2], this.#frame), true)
  }

  /** Show one photo px as one CSS px. */
  actual(): void {
    this.zoom(1 / this.#view.scale)
  }

  /** Scale about a place in the window (CSS px), without one about the middle. */
  zoom(factor: number, about?: Point): void {
    if (!this.#ready) return
    const { width, height } = this.#frame.window
    this.#look(zoomAbout(this.#view, factor, about ?? [width / 2, height / 2], this.#frame))
  }

  /** CSS px. */
  pan(by: Point): void {
    if (this.#ready) this.#look(panBy(this.#view, by))
  }

  /** Bring a place of the photo into the window. */
  show(place: Point): void {
    const view = showing(this.#view, place, LEEWAY, this.#frame)
    if (view.x !== this.#view.x || view.y !== this.#view.y) this.#look(view)
  }

  get #ready(): boolean {
    const { photo, window } = this.#frame
    return Math.min(photo.width, photo.height, window.width, window.height) > 0
  }

  #look(view: View, whole = false): void {
    this.#fitted = whole
    this.#view = clampView(view, this.#frame)
    this.changed(this.#view)
  }
}

function alike(one: number, other: number): boolean {
  return Math.abs(one - other) <= 1e-6 * Math.max(1, Math.abs(one))
}
