import type { Point } from '../strokes'

/** Where the sheet lies in its window: CSS px per sheet px, and the place of its top left corner, CSS px. */
export interface View {
  readonly scale: number
  readonly x: number
  readonly y: number
}

export interface Size {
  readonly width: number
  readonly height: number
}

/** The size of the sheet (sheet px) and of the window that shows it (CSS px). */
export interface Frame {
  readonly sheet: Size
  readonly window: Size
}

/** Room around a sheet that is shown whole, CSS px. */
const MARGIN = 24
/** The smallest scale, as a share of the one that shows the whole sheet. */
const MIN_SHARE_OF_FIT = 0.5
/** CSS px per sheet px. */
const MAX_SCALE = 40
/** How much of the sheet always stays in the window, CSS px. */
const KEPT_IN_VIEW = 80

/** Convert a point of the window (CSS px) to sheet px. */
export function toSheet({ scale, x, y }: View, [left, top]: Point): Point {
  return [(left - x) / scale, (top - y) / scale]
}

/** Convert a point of the sheet (sheet px) to CSS px in the window. */
export function toScreen({ scale, x, y }: View, [across, down]: Point): Point {
  return [across * scale + x, down * scale + y]
}

/** Return the view moved by an offset, CSS px. */
export function panBy({ scale, x, y }: View, [right, down]: Point): View {
  return { scale, x: x + right, y: y + down }
}

/** Return the view that shows the whole sheet in the middle of the window. */
export function fitView({ sheet, window }: Frame): View {
  const margin = Math.min(MARGIN, window.width / 20, window.height / 20)
  const scale = Math.min((window.width - 2 * margin) / sheet.width, (window.height - 2 * margin) / sheet.height)
  return centreView(scale, [sheet.width / 2, sheet.height / 2], { sheet, window })
}

/** Return the view that shows a point of the sheet in the middle of the window. */
export function centreView(scale: number, [across, down]: Point, { window }: Frame): View {
  return { scale, x: window.width / 2 - across * scale, y: window.height / 2 - down * scale }
}

/** Return the view scaled by a factor, within the limits; what lies at `at` (CSS px) stays there. */
export function zoomAbout(view: View, factor: number, at: Point, frame: Frame): View {
  const scale = within(view.scale * factor, ...scaleLimits(frame))
  const [across, down] = toSheet(view, at)
  return { scale, x: at[0] - across * scale, y: at[1] - down * scale }
}

/** Return the view, moved where too little of the sheet would be left in the window. */
export function clampView({ scale, x, y }: View, { sheet, window }: Frame): View {
  return {
    scale,
    x: clampOffset(x, sheet.width * scale, window.width),
    y: clampOffset(y, sheet.height * scale, window.height),
  }
}

/** Return the view moved as little as brings a point of the sheet at least `margin` CSS px inside the window. */
export function panIntoView(view: View, point: Point, margin: number, { window }: Frame): View {
  const [left, top] = toScreen(view, point)
  return panBy(view, [
    within(left, margin, Math.max(margin, window.width - margin)) - left,
    within(top, margin, Math.max(margin, window.height - margin)) - top,
  ])
}

/** Return the smallest and the largest scale. */
export function scaleLimits(frame: Frame): [least: number, most: number] {
  const fit = fitView(frame).scale
  return [MIN_SHARE_OF_FIT * fit, Math.max(MAX_SCALE, fit)]
}

/** Return a value limited to a range. */
export function within(value: number, least: number, most: number): number {
  return Math.min(Math.max(value, least), most)
}

function clampOffset(offset: number, length: number, windowLength: number): number {
  const kept = Math.min(KEPT_IN_VIEW, length, windowLength)
  return within(offset, kept - length, windowLength - kept)
}
