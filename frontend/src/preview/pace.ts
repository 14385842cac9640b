import type { Viewport } from './camera'
import { softwarePixelRatio } from './software'

/** A frame that takes longer (ms) is drawn by the processor, whatever the renderer's name says. */
const SLOW_FRAME = 150
/** How many frames with a tree are timed; the first one also compiles the shaders. */
const TIMED_FRAMES = 3

/** Knows whether the processor draws, by the first frames where the renderer does not tell, and how many pixels it can draw. */
export class Pace {
  private timed = 0

  /** `isKnown`: whether `software` is certain; otherwise the first frames are timed to check it. */
  constructor(
    public software: boolean,
    isKnown: boolean,
  ) {
    if (isKnown) this.timed = TIMED_FRAMES
  }

  /** Return how many pixels per CSS px are drawn in time. */
  pixelRatio(viewport: Viewport, moving: boolean): number {
    return this.software ? softwarePixelRatio(viewport, moving) : Math.min(devicePixelRatio, 2)
  }

  /** Time a frame with a tree that began at `start` (ms), once `finish` has waited for it; returns whether it shows that the processor draws. */
  isFoundSlow(start: number, finish: () => void): boolean {
    if (this.software || this.timed++ >= TIMED_FRAMES) return false
    finish()
    if (this.timed === 1 || performance.now() - start < SLOW_FRAME) return false
    this.software = true
    return true
  }
}
