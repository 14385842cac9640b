import type { Point } from '../strokes'

/** Where the photo lies in its window: CSS px per photo px, and the CSS px from the window's corner to the photo's. */
export interface View {
  readonly scale: number
  readonly x: number
  readonly y: number
}

export interface Size {
  readonly width: number
  readonly height: number
}

/** The photo (photo px) and the window that it is seen through (CSS px). */
export interface Frame {
  readonly photo: Size
  readonly window: Size
}

const MARGIN = 24
const SMALLEST_OF_FIT = 0.5
const MOST_SCALE = 40
/** As much of the photo stays in the window, CSS px. */
const HOLD = 80

/** Map a place in the window (CSS px) to the photo. */
export function toPhoto({ scale, x, y }: View, [left, top]: Point): Point {
  return [(left - x) / scale, (top - y) / scale]
}

/** Map a place in the photo to the window (CSS px). */
export function toScreen({ scale, x, y }: View, [across, down]: Point): Point {
  return [across * scale + x, down * scale + y]
}

export function panBy({ scale, x, y }: View, [right, down]: Point): View {
  return { scale, x: x + right, y: y + down }
}

/** Show the whole photo in the middle of the window. */
export function fitted({ photo, window }: Frame): View {
  const margin = Math.min(MARGIN, window.width / 20, window.height / 20)
  const scale = Math.min((window.width - 2 * margin) / photo.width, (window.height - 2 * margin) / photo.height)
  return centred(scale, [photo.width / 2, photo.height / 2], { photo, window })
}

/** Show a place of the photo in the middle of the window. */
export function centred(scale: number, [across, down]: Point, { window }: Frame): View {
  return { scale, x: window.width / 2 - across * scale, y: window.height / 2 - down * scale }
}

/** Scale by a factor, within the limits; the place under `at` (CSS px) stays there. */
export function zoomAbout(view: View, factor: number, at: Point, frame: Frame): View {
  const scale = within(view.scale * factor, ...limits(frame))
  const [across, down] = toPhoto(view, at)
  return { scale, x: at[0] - across * scale, y: at[1] - down * scale }
}

/** Keep some of the photo in the window. */
export function clampView({ scale, x, y }: View, { photo, window }: Frame): View {
  return {
    scale,
    x: held(x, photo.width * scale, window.width),
    y: held(y, photo.height * scale, window.height),
  }
}

/** Pan as little as brings a place of the photo at least `margin` CSS px inside the window. */
export function showing(view: View, place: Point, margin: number, { window }: Frame): View {
  const [left, top] = toScreen(view, place)
  return panBy(view, [
    within(left, margin, Math.max(margin, window.width - margin)) - left,
    within(top, margin, Math.max(margin, window.height - margin)) - top,
  ])
}

/** Least and most scale. */
export function limits(frame: Frame): [least: number, most: number] {
  const whole = fitted(frame).scale
  return [SMALLEST_OF_FIT * whole, Math.max(MOST_SCALE, whole)]
}

export function within(value: number, least: number, most: number): number {
  return Math.min(Math.max(value, least), most)
}

function held(offset: number, length: number, room: number): number {
  const hold = Math.min(HOLD, length, room)
  return within(offset, hold - length, room - hold)
}
