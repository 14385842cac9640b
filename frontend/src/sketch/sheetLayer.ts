import type { Sheet } from '../state'
import type { DrawTarget } from './drawTarget'
import { INK, PAPER } from './ink'

/** How often a picture is halved: shrinking the full one at each draw would be slow, and flicker while zooming. */
const HALVINGS = 4
/** From this scale on, CSS px per sheet px, the picture's pixels are shown as squares. */
const SQUARE_PIXELS_SCALE = 12

/** Draws a sheet, its paper and its picture, at any scale. */
export class SheetLayer {
  #sheet: Sheet | null = null
  /** The picture, and smaller copies of it, each half as large as the one before. */
  #levels: CanvasImageSource[] = []

  /** `onLoad` is called when a picture can be drawn. */
  constructor(private readonly onLoad: () => void) {}

  /** Show another sheet, or none. */
  show(sheet: Sheet | null): void {
    const before = this.#sheet
    this.#sheet = sheet
    if (sheet?.url === before?.url) return
    this.#levels = []
    if (sheet?.url) void this.#load(sheet.url)
  }

  /** Draw the sheet; on `paper` its picture is half transparent. */
  draw({ ctx, density, view: { scale, x, y } }: DrawTarget, paper: boolean): void {
    if (!this.#sheet) return
    const { width, height, hidden } = this.#sheet
    ctx.setTransform(density * scale, 0, 0, density * scale, density * x, density * y)
    if (paper) drawPaper(ctx, this.#sheet)
    const halvings = Math.floor(Math.log2(1 / Math.min(1, scale * density)))
    const picture = this.#levels[Math.min(halvings, this.#levels.length - 1)]
    ctx.imageSmoothingEnabled = scale < SQUARE_PIXELS_SCALE
    ctx.globalAlpha = paper ? PAPER.veil : 1
    if (picture && !hidden) ctx.drawImage(picture, 0, 0, width, height)
    ctx.globalAlpha = 1
    if (!picture && !paper) return
    ctx.strokeStyle = paper ? PAPER.edge : INK.photoEdge
    ctx.lineWidth = 1 / scale
    ctx.strokeRect(0, 0, width, height)
  }

  async #load(url: string): Promise<void> {
    const picture = new Image()
    picture.src = url
    await picture.decode().catch(() => undefined)
    if (this.#sheet?.url !== url || !picture.naturalWidth) return
    this.#levels = halvedCopies(picture)
    this.onLoad()
  }
}

function drawPaper(ctx: CanvasRenderingContext2D, { width, height }: Sheet): void {
  ctx.shadowColor = PAPER.shade
  ctx.shadowBlur = 14
  ctx.shadowOffsetY = 3
  ctx.fillStyle = PAPER.white
  ctx.fillRect(0, 0, width, height)
  ctx.shadowColor = 'transparent'
}

function halvedCopies(picture: HTMLImageElement): CanvasImageSource[] {
  const levels: HTMLCanvasElement[] = [resized(picture, picture.naturalWidth, picture.naturalHeight)]
  for (let level = 1; level <= HALVINGS; level++) {
    const { width, height } = levels[level - 1]!
    levels.push(resized(levels[level - 1]!, Math.ceil(width / 2), Math.ceil(height / 2)))
  }
  return levels
}

function resized(source: CanvasImageSource, width: number, height: number): HTMLCanvasElement {
  const canvas = document.createElement('canvas')
  canvas.width = width
  canvas.height = height
  const ctx = canvas.getContext('2d')!
  ctx.imageSmoothingQuality = 'high'
  ctx.drawImage(source, 0, 0, width, height)
  return canvas
}
