import type { Sheet } from '../state'
import type { DrawTarget } from './drawTarget'
import { INK, PAPER } from './ink'

/** A photo that is shown much smaller than it is would be slow to draw and glitter; halves of halves are neither. */
const HALVINGS = 4
/** From this scale on the photo's pixels are shown as such. */
const PIXELS_SHOW = 12

/** The upright picture or the paper, ready to be drawn at any scale. */
export class PhotoLayer {
  #sheet: Sheet | null = null
  #levels: CanvasImageSource[] = []

  constructor(private readonly loaded: () => void) {}

  /** Show another photo or paper, or none; `loaded` is called when its picture can be drawn. */
  show(sheet: Sheet | null): void {
    const before = this.#sheet
    this.#sheet = sheet
    if (sheet?.url === before?.url) return
    this.#levels = []
    if (sheet?.url) void this.#load(sheet.url)
  }

  /** Draw the photo; on `paper` it shines through. */
  draw({ ctx, density, view: { scale, x, y } }: DrawTarget, paper: boolean): void {
    if (!this.#sheet) return
    const { width, height, hidden } = this.#sheet
    ctx.setTransform(density * scale, 0, 0, density * scale, density * x, density * y)
    if (paper) drawPaper(ctx, this.#sheet)
    const shrunk = Math.floor(Math.log2(1 / Math.min(1, scale * density)))
    const picture = this.#levels[Math.min(shrunk, this.#levels.length - 1)]
    ctx.imageSmoothingEnabled = scale < PIXELS_SHOW
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
    this.#levels = halvings(picture)
    this.loaded()
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

function halvings(picture: HTMLImageElement): CanvasImageSource[] {
  const levels: HTMLCanvasElement[] = [drawn(picture, picture.naturalWidth, picture.naturalHeight)]
  for (let level = 1; level <= HALVINGS; level++) {
    const { width, height } = levels[level - 1]!
    levels.push(drawn(levels[level - 1]!, Math.ceil(width / 2), Math.ceil(height / 2)))
  }
  return levels
}

function drawn(source: CanvasImageSource, width: number, height: number): HTMLCanvasElement {
  const canvas = document.createElement('canvas')
  canvas.width = width
  canvas.height = height
  const ctx = canvas.getContext('2d')!
  ctx.imageSmoothingQuality = 'high'
  ctx.drawImage(source, 0, 0, width, height)
  return canvas
}
