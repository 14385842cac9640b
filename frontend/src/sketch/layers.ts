import type { DrawTarget } from './drawTarget'
import type { Size, View } from './viewport'

/** From bottom to top. */
const NAMES = ['photo', 'traced', 'strokes', 'pen'] as const
export type LayerName = (typeof NAMES)[number]
export type Painters = Record<LayerName, (target: DrawTarget) => void>

/** A stack of canvases; those that were invalidated are repainted in the next frame. */
export class Layers {
  readonly #canvases = new Map<LayerName, CanvasRenderingContext2D>()
  readonly #invalid = new Set<LayerName>()
  #frame = 0
  #density = 1

  constructor(
    host: HTMLElement,
    private readonly painters: Painters,
    private readonly view: () => View,
  ) {
    for (const name of NAMES) {
      const canvas = document.createElement('canvas')
      canvas.className = `sketch-layer sketch-${name}`
      host.append(canvas)
      this.#canvases.set(name, canvas.getContext('2d')!)
    }
  }

  /** Set the size of the window (CSS px) and the device px per CSS px. */
  resize({ width, height }: Size, density: number): void {
    this.#density = density
    for (const { canvas } of this.#canvases.values()) {
      canvas.width = Math.round(width * density)
      canvas.height = Math.round(height * density)
    }
    // Resizing clears a canvas; it is repainted at once so that it is never shown empty.
    this.invalidate(...NAMES)
    this.#repaint()
  }

  invalidate(...names: LayerName[]): void {
    for (const name of names) this.#invalid.add(name)
    this.#frame ||= requestAnimationFrame(() => this.#repaint())
  }

  invalidateAll(): void {
    this.invalidate(...NAMES)
  }

  #repaint(): void {
    cancelAnimationFrame(this.#frame)
    this.#frame = 0
    for (const name of this.#invalid) this.#paint(name, this.#canvases.get(name)!)
    this.#invalid.clear()
  }

  #paint(name: LayerName, ctx: CanvasRenderingContext2D): void {
    ctx.resetTransform()
    ctx.clearRect(0, 0, ctx.canvas.width, ctx.canvas.height)
    this.painters[name]({ ctx, density: this.#density, view: this.view() })
  }
}
