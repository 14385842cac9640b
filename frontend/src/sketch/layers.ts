import type { DrawTarget } from './drawTarget'
import type { Size, View } from './viewport'

/** Bottom to top. */
const NAMES = ['photo', 'traced', 'strokes', 'pen'] as const
export type LayerName = (typeof NAMES)[number]
export type Paint = Record<LayerName, (target: DrawTarget) => void>

/** Canvases one above the other; those that were touched are painted anew in the next frame. */
export class Layers {
  readonly #canvases = new Map<LayerName, CanvasRenderingContext2D>()
  readonly #touched = new Set<LayerName>()
  #frame = 0
  #density = 1

  constructor(
    host: HTMLElement,
    private readonly paint: Paint,
    private readonly view: () => View,
  ) {
    for (const name of NAMES) {
      const canvas = document.createElement('canvas')
      canvas.className = `sketch-layer sketch-${name}`
      host.append(canvas)
      this.#canvases.set(name, canvas.getContext('2d')!)
    }
  }

  /** CSS px of the window, and device px per CSS px. */
  resize({ width, height }: Size, density: number): void {
    this.#density = density
    for (const { canvas } of this.#canvases.values()) {
      canvas.width = Math.round(width * density)
      canvas.height = Math.round(height * density)
    }
    // A canvas that was resized is empty; waiting for the next frame would show it so.
    this.touch(...NAMES)
    this.#repaint()
  }

  touch(...names: LayerName[]): void {
    for (const name of names) this.#touched.add(name)
    this.#frame ||= requestAnimationFrame(() => this.#repaint())
  }

  touchAll(): void {
    this.touch(...NAMES)
  }

  #repaint(): void {
    cancelAnimationFrame(this.#frame)
    this.#frame = 0
    for (const name of this.#touched) this.#paint(name, this.#canvases.get(name)!)
    this.#touched.clear()
  }

  #paint(name: LayerName, ctx: CanvasRenderingContext2D): void {
    ctx.resetTransform()
    ctx.clearRect(0, 0, ctx.canvas.width, ctx.canvas.height)
    this.paint[name]({ ctx, density: this.#density, view: this.view() })
  }
}
