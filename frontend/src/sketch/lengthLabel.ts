import type { Line, Point, Scale } from '../strokes'
import { text } from '../text'
import type { DrawTarget } from './drawTarget'
import { INK } from './ink'
import { type Size, toScreen, type View } from './viewport'

const FONT = '600 13px system-ui, sans-serif'
/** CSS px, as all sizes here. */
const HEIGHT = 22
const PADDING = 8
/** Between the line and its label; the line's ticks need some of it. */
const GAP = 14

/** Return where to centre a label of this size so that it lies beside a measured line, right of it or below; CSS px. */
export function labelPlace([from, to]: Line, view: View, { width, height }: Size): Point {
  const [x, y] = toScreen(view, from!)
  const [toX, toY] = toScreen(view, to!)
  const length = Math.hypot(toX - x, toY - y) || 1
  const [across, down] = [(y - toY) / length, (toX - x) / length]
  const away = GAP + (Math.abs(across) * width + Math.abs(down) * height) / 2
  const side = across + down < 0 ? -away : away
  return [(x + toX) / 2 + side * across, (y + toY) / 2 + side * down]
}

/** Write a measured line's length beside it. */
export function drawLength({ ctx, density, view }: DrawTarget, { points, metres }: Scale): void {
  const label = text.metres(metres)
  ctx.setTransform(density, 0, 0, density, 0, 0)
  ctx.font = FONT
  const width = ctx.measureText(label).width + 2 * PADDING
  const [x, y] = labelPlace(points, view, { width, height: HEIGHT })
  ctx.fillStyle = INK.label
  ctx.beginPath()
  ctx.roundRect(x - width / 2, y - HEIGHT / 2, width, HEIGHT, HEIGHT / 2)
  ctx.fill()
  ctx.fillStyle = INK.scale
  ctx.textAlign = 'center'
  ctx.textBaseline = 'middle'
  ctx.fillText(label, x, y + 1)
}
