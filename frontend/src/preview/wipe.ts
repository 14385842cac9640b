import type { Rect, Viewport } from './camera'

/** How far the keys move the handle, as shares of the photo's shown width. */
const STEPS: Record<string, number> = { ArrowLeft: -0.02, ArrowDown: -0.02, ArrowRight: 0.02, ArrowUp: 0.02 }

const PICTURE = 'preview-photo'

/** The photo, or a video's frame, over the canvas, visible left of a handle that can be dragged across it. */
export class Wipe {
  private readonly photo = document.createElement('img')
  /** A video's frame, which takes the photo's place. */
  private film: HTMLCanvasElement | null = null
  private readonly handle = document.createElement('div')
  /** How much of the photo is visible, 0..1 from the left. */
  private share = 0.5
  private rect: Rect | null = null
  private viewport: Viewport = { width: 0, height: 0 }

  constructor(host: HTMLElement, label: string) {
    this.photo.className = PICTURE
    this.photo.alt = ''
    this.handle.className = 'preview-wipe'
    for (const [name, value] of Object.entries({ role: 'slider', tabindex: '0', 'aria-label': label }))
      this.handle.setAttribute(name, value)
    for (const [name, value] of Object.entries({ 'aria-valuemin': '0', 'aria-valuemax': '100' }))
      this.handle.setAttribute(name, value)
    this.handle.addEventListener('pointerdown', event => this.handle.setPointerCapture(event.pointerId))
    this.handle.addEventListener('pointermove', event => this.drag(event))
    this.handle.addEventListener('keydown', event => this.key(event))
    host.append(this.photo, this.handle)
    this.update()
  }

  /** Set the photo's address; null for none. */
  show(url: string | null): void {
    if (url) this.photo.src = url
    else this.photo.removeAttribute('src')
    this.update()
  }

  /** Show a video's frame in the photo's place; null shows the photo again. */
  showFilm(canvas: HTMLCanvasElement | null): void {
    this.film?.remove()
    this.film = canvas
    if (canvas) {
      canvas.className = PICTURE
      this.photo.after(canvas)
    }
    this.photo.hidden = canvas !== null
    this.update()
  }

  /** Set how much of the tree is visible: only the tree (1), only the photo (0) or a part of both. */
  set(fraction: number): void {
    this.share = 1 - Math.min(Math.max(fraction, 0), 1)
    this.update()
  }

  /** Lay the photo over a rectangle of the host; null fades it out. */
  place(rect: Rect | null, viewport: Viewport): void {
    this.rect = rect
    this.viewport = viewport
    this.update()
  }

  /** Draw the visible part of the photo, with `scale` pixels per CSS px. */
  draw(ctx: OffscreenCanvasRenderingContext2D, scale: number): void {
    const picture = this.film ?? this.photo
    if (!this.rect || !(this.film?.width || (this.photo.complete && this.photo.naturalWidth))) return
    const { x, y, width, height } = this.rect
    ctx.save()
    ctx.scale(scale, scale)
    ctx.beginPath()
    ctx.rect(0, 0, this.edgeOf(this.rect), this.viewport.height)
    ctx.clip()
    ctx.drawImage(picture, x, y, width, height)
    ctx.restore()
  }

  /** Return the left and right ends of the photo within the host, CSS px. */
  private shownSpan(rect: Rect): [number, number] {
    return [Math.max(rect.x, 0), Math.min(rect.x + rect.width, this.viewport.width)]
  }

  /** Return where the photo ends and the tree begins, CSS px from the host's left. */
  private edgeOf(rect: Rect): number {
    const [left, right] = this.shownSpan(rect)
    return left + (right - left) * this.share
  }

  private update(): void {
    const picture = this.film ?? this.photo
    const shown = this.rect !== null && (this.film !== null || this.photo.hasAttribute('src'))
    picture.classList.toggle('preview-gone', !shown)
    this.handle.hidden = !shown
    const percent = Math.round(this.share * 100)
    this.handle.setAttribute('aria-valuenow', String(percent))
    this.handle.setAttribute('aria-valuetext', `${percent} %`)
    if (!this.rect) return
    const edge = this.edgeOf(this.rect)
    const { x, y, width, height } = this.rect
    Object.assign(picture.style, { left: `${x}px`, top: `${y}px`, width: `${width}px`, height: `${height}px` })
    picture.style.clipPath = `inset(0 ${Math.max(x + width - edge, 0)}px 0 0)`
    this.handle.style.left = `${edge}px`
  }

  private drag(event: PointerEvent): void {
    if (!this.rect || !this.handle.hasPointerCapture(event.pointerId)) return
    const [left, right] = this.shownSpan(this.rect)
    const origin = this.handle.offsetParent?.getBoundingClientRect().left ?? 0
    this.set(1 - (event.clientX - origin - left) / Math.max(right - left, 1))
  }

  private key(event: KeyboardEvent): void {
    const step = STEPS[event.key]
    const end = event.key === 'Home' ? 1 : event.key === 'End' ? 0 : null
    if (step === undefined && end === null) return
    event.preventDefault()
    this.set(end ?? 1 - this.share - step!)
  }
}
