import type { Levels } from '../sheets'
import { text } from '../text'
import type { DrawTarget } from './drawTarget'
import { type Inks, PAPER_INK } from './ink'

/** The lines to draw on one sheet, sheet px. */
export interface LevelLines {
  /** Where the trees of all sheets should stand and end. */
  readonly levels: Levels
  /** Where this sheet's tree does, if that is elsewhere. */
  readonly stray: Levels | null
  /** The sheet's width. */
  readonly width: number
}

/** How a level line is drawn: its left and right ends, its colour and width; CSS px. */
interface LineStyle {
  readonly from: number
  readonly to: number
  readonly colour: string
  readonly width: number
}

interface LabelStyle {
  readonly colour: string
  readonly align: 'left' | 'right'
  /** CSS px from the window's left. */
  readonly x: number
}

const FONT = '500 12px system-ui, sans-serif'
const DOTS = [2, 5]
/** CSS px. */
const WIDTH = 1
const CASING = 3
const LABEL_MARGIN = 8
/** A stray line that is nearer than this to the common one leaves the label to the other, CSS px. */
const CROWDED = 18

/** Draw lines across the window where the trees of all sheets should stand and end, and where a stray one does. */
export function drawLevels(target: DrawTarget, { levels, stray, width }: LevelLines, inks: Inks): void {
  const { ctx, density, view } = target
  ctx.setTransform(density, 0, 0, density, 0, 0)
  ctx.lineCap = 'butt'
  const lines = [levels.root, levels.top].map(down => screenY(target, down))
  const acrossWindow = { from: 0, to: ctx.canvas.width / density, colour: PAPER_INK.level, width: WIDTH }
  const sheet = { from: view.x, to: view.x + width * view.scale }
  for (const y of lines) line(ctx, y, acrossWindow)
  for (const y of inks === PAPER_INK ? [] : lines) {
    line(ctx, y, { ...sheet, colour: inks.levelCasing, width: CASING })
    line(ctx, y, { ...sheet, colour: inks.level, width: WIDTH })
  }
  const { root, top } = text.sheets.levels
  const x = LABEL_MARGIN + Math.max(0, view.x)
  for (const [at, words] of [root, top].entries())
    label(ctx, lines[at]!, words, { colour: inks.levelWords, align: 'left', x })
  if (stray) drawStray(target, [stray.root, stray.top], { ...acrossWindow, colour: inks.stray }, lines)
}

/** Draw dotted lines where a sheet's own tree stands and ends, one with a label that says that it will be fitted. */
function drawStray(target: DrawTarget, stray: readonly number[], style: LineStyle, lines: readonly number[]): void {
  const { ctx } = target
  const own = stray.map(down => screenY(target, down))
  ctx.setLineDash(DOTS)
  for (const y of own) line(ctx, y, { ...style, width: 1.5 * WIDTH })
  ctx.setLineDash([])
  const far = own.findIndex((y, at) => Math.abs(y - lines[at]!) > CROWDED)
  label(ctx, own[Math.max(far, 0)]!, text.sheets.stray, {
    colour: style.colour,
    align: 'right',
    x: style.to - LABEL_MARGIN,
  })
}

/** Convert a height on the sheet (sheet px) to CSS px, at the middle of a px so that a thin line is sharp. */
function screenY({ view }: DrawTarget, down: number): number {
  return Math.round(view.y + down * view.scale) + 0.5
}

function line(ctx: CanvasRenderingContext2D, y: number, { from, to, colour, width }: LineStyle): void {
  ctx.strokeStyle = colour
  ctx.lineWidth = width
  ctx.beginPath()
  ctx.moveTo(from, y)
  ctx.lineTo(to, y)
  ctx.stroke()
}

function label(ctx: CanvasRenderingContext2D, y: number, words: string, { colour, align, x }: LabelStyle): void {
  ctx.font = FONT
  ctx.fillStyle = colour
  ctx.textAlign = align
  ctx.textBaseline = 'bottom'
  ctx.fillText(words, x, y - 2)
}
