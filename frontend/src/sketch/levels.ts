import type { Levels } from '../sheets'
import { text } from '../text'
import type { DrawTarget } from './drawTarget'
import { type Inks, PAPER_INK } from './ink'

/** The lines of all sheets, and those that one's own tree stands and ends at. */
export interface LevelLines {
  readonly levels: Levels
  readonly stray: Levels | null
  /** Of the photo or paper, px of it. */
  readonly width: number
}

/** How a line is drawn from one place across the window to another, CSS px. */
interface Ruled {
  readonly from: number
  readonly to: number
  readonly colour: string
  readonly width: number
}

interface Words {
  readonly colour: string
  readonly align: 'left' | 'right'
  /** CSS px. */
  readonly across: number
}

const FONT = '500 12px system-ui, sans-serif'
const DOTS = [2, 5]
/** CSS px. */
const WIDTH = 1
const CASING = 3
const AWAY = 8
/** A line as near to another has no words of its own, CSS px. */
const CROWDED = 18

/** Draw lines across the window where the trees of all sheets stand and end. */
export function drawLevels(target: DrawTarget, { levels, stray, width }: LevelLines, inks: Inks): void {
  const { ctx, density, view } = target
  ctx.setTransform(density, 0, 0, density, 0, 0)
  ctx.lineCap = 'butt'
  const lines = [levels.root, levels.top].map(down => screen(target, down))
  const all = { from: 0, to: ctx.canvas.width / density, colour: PAPER_INK.level, width: WIDTH }
  const photo = { from: view.x, to: view.x + width * view.scale }
  for (const y of lines) line(ctx, y, all)
  for (const y of inks === PAPER_INK ? [] : lines) {
    line(ctx, y, { ...photo, colour: inks.levelCasing, width: CASING })
    line(ctx, y, { ...photo, colour: inks.level, width: WIDTH })
  }
  const { root, top } = text.sheets.levels
  const across = AWAY + Math.max(0, view.x)
  for (const [at, words] of [root, top].entries())
    label(ctx, lines[at]!, words, { colour: inks.levelWords, align: 'left', across })
  if (stray) drawStray(target, [stray.root, stray.top], { ...all, colour: inks.stray }, lines)
}

/** Dot the lines of a tree that stands or ends elsewhere, and say beside one that it will be fitted. */
function drawStray(target: DrawTarget, stray: readonly number[], ruled: Ruled, lines: readonly number[]): void {
  const { ctx } = target
  const own = stray.map(down => screen(target, down))
  ctx.setLineDash(DOTS)
  for (const y of own) line(ctx, y, { ...ruled, width: 1.5 * WIDTH })
  ctx.setLineDash([])
  const far = own.findIndex((y, at) => Math.abs(y - lines[at]!) > CROWDED)
  label(ctx, own[Math.max(far, 0)]!, text.sheets.stray, {
    colour: ruled.colour,
    align: 'right',
    across: ruled.to - AWAY,
  })
}

function screen({ view }: DrawTarget, down: number): number {
  return Math.round(view.y + down * view.scale) + 0.5
}

function line(ctx: CanvasRenderingContext2D, y: number, { from, to, colour, width }: Ruled): void {
  ctx.strokeStyle = colour
  ctx.lineWidth = width
  ctx.beginPath()
  ctx.moveTo(from, y)
  ctx.lineTo(to, y)
  ctx.stroke()
}

function label(ctx: CanvasRenderingContext2D, y: number, words: string, { colour, align, across }: Words): void {
  ctx.font = FONT
  ctx.fillStyle = colour
  ctx.textAlign = align
  ctx.textBaseline = 'bottom'
  ctx.fillText(words, across, y - 2)
}
