import type { Photo } from '../state'
import { INK } from './ink'
import type { Sheet } from './overlay'

/** A photo that is shown much smaller than it is would be slow to draw and glitter; halves of halves are neither. */
const HALVINGS = 4
/** From this scale on the photo's pixels are shown as such. */
const PIXELS_SHOW = 12

/** The upright picture, ready to be drawn at any scale. */
export class PhotoLayer {
  #photo: Photo | null = null
  #levels: CanvasImageSource[] = []

  constructor(private readonly loaded: () => void) {}

  /** Show another photo, or none; `loaded` is called when it can be drawn. */
  show(photo: Photo | null): void {
    if (photo?.url === this.#photo?.url) return
    this.#photo = photo
    this.#levels = []
    if (photo) void this.#load(photo)
  }

  draw({ ctx, density, view: { scale, x, y } }: Sheet): void {
    const shrunk = Math.floor(Math.log2(1 / Math.min(1, scale * density)))
    const picture = this.#levels[Math.min(shrunk, this.#levels.length - 1)]
    if (!picture || !this.#photo) return
    ctx.setTransform(density * scale, 0, 0, density * scale, density * x, density * y)
    ctx.imageSmoothingEnabled = scale < PIXELS_SHOW
    ctx.drawImage(picture, 0, 0, this.#photo.width, this.#photo.height)
    ctx.strokeStyle = INK.photoEdge
    ctx.lineWidth = 1 / scale
    ctx.strokeRect(0, 0, this.#photo.width, this.#photo.height)
  }

  async #load(photo: Photo): Promise<void> {
    const picture = new Image()
    picture.src = photo.url
    await picture.decode().catch(() => undefined)
    if (this.#photo !== photo || !picture.naturalWidth) return
    this.#levels = halvings(picture)
    this.loaded()
  }
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
