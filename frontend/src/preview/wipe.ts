import type { Rect, Viewport } from './camera'

const STEPS: Record<string, number> = { ArrowLeft: -0.02, ArrowDown: -0.02, ArrowRight: 0.02, ArrowUp: 0.02 }

/** The photo over the canvas, seen left of a handle that is dragged across it. */
export class Wipe {
  private readonly photo = document.createElement('img')
  private readonly handle = document.createElement('div')
  private share = 0.5
  private rect: Rect | null = null
  private room: Viewport = { width: 0, height: 0 }

  constructor(host: HTMLElement, label: string) {
    this.photo.className = 'preview-photo'
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
    this.lay()
  }

  /** The picture that lies here, or none. */
  show(url: string | null): void {
    if (url) this.photo.src = url
    else this.photo.removeAttribute('src')
    this.lay()
  }

  /** Show only the tree (1), only the photo (0) or part of both. */
  set(fraction: number): void {
    this.share = 1 - Math.min(Math.max(fraction, 0), 1)
    this.lay()
  }

  /** Lie over this rectangle of the host; null: fade out. */
  place(rect: Rect | null, room: Viewport): void {
    this.rect = rect
    this.room = room
    this.lay()
  }

  /** Draw what is seen of the photo, `scale` pixels for each CSS pixel. */
  draw(pen: OffscreenCanvasRenderingContext2D, scale: number): void {
    if (!this.rect || !this.photo.complete || !this.photo.naturalWidth) return
    const { x, y, width, height } = this.rect
    pen.save()
    pen.scale(scale, scale)
    pen.beginPath()
    pen.rect(0, 0, this.edge(this.rect), this.room.height)
    pen.clip()
    pen.drawImage(this.photo, x, y, width, height)
    pen.restore()
  }

  /** What part of the host, from left to right, the photo's rectangle takes. */
  private span(rect: Rect): [number, number] {
    return [Math.max(rect.x, 0), Math.min(rect.x + rect.width, this.room.width)]
  }

  /** Where the photo ends and the tree begins. */
  private edge(rect: Rect): number {
    const [left, right] = this.span(rect)
    return left + (right - left) * this.share
  }

  private lay(): void {
    const shown = this.rect !== null && this.photo.hasAttribute('src')
    this.photo.classList.toggle('preview-gone', !shown)
    this.handle.hidden = !shown
    const percent = Math.round(this.share * 100)
    this.handle.setAttribute('aria-valuenow', String(percent))
    this.handle.setAttribute('aria-valuetext', `${percent} %`)
    if (!this.rect) return
    const edge = this.edge(this.rect)
    const { x, y, width, height } = this.rect
    Object.assign(this.photo.style, { left: `${x}px`, top: `${y}px`, width: `${width}px`, height: `${height}px` })
    this.photo.style.clipPath = `inset(0 ${Math.max(x + width - edge, 0)}px 0 0)`
    this.handle.style.left = `${edge}px`
  }

  private drag(event: PointerEvent): void {
    if (!this.rect || !this.handle.hasPointerCapture(event.pointerId)) return
    const [left, right] = this.span(this.rect)
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
