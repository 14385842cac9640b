import type { Playhead, Span } from '../playhead'
import type { MotionInfo } from './content'
import { MEASURED, type Sway } from './sway'

/** The animation that is played first of a tree that was not filmed. */
const FIRST = 'breeze'

/** A tree that may move. */
interface Moving {
  readonly sway: Sway | null
  readonly motion: MotionInfo | null
}

/** Moves the shown tree by the playhead: which animation it plays, and how strongly. */
export class Motion {
  private tree: Moving | null = null
  /** The animation that the user chose; undefined before. */
  private wanted: string | null | undefined
  /** How far branches turn from their means, as a factor. */
  gain = 1

  /** A calm one plays nothing until it is asked to. */
  constructor(
    private readonly playhead: Playhead,
    private isCalm: boolean,
  ) {}

  get animations(): readonly string[] {
    return this.tree?.sway?.animations ?? []
  }

  /** The animation that the tree shows; null where it stands still. */
  get animation(): string | null {
    const { animations, wanted } = this
    if (wanted === null) return null
    if (wanted !== undefined && animations.includes(wanted)) return wanted
    if (animations[0] === MEASURED) return MEASURED
    if (wanted === undefined && this.isCalm) return null
    return animations.find(name => name === FIRST) ?? animations[0] ?? null
  }

  /** Move another tree; null for none. */
  show(tree: Moving | null): void {
    const isFirst = this.tree?.sway?.animations === undefined
    this.tree = tree
    tree?.sway?.setGain(this.gain)
    this.apply(false)
    if (isFirst && this.animation && !this.isCalm) this.playhead.play()
  }

  /** Play an animation, by its name; null for none. */
  choose(name: string | null): void {
    const wasStill = this.animation === null
    this.wanted = name
    this.apply(this.playhead.playing && !wasStill)
    if (name !== null) this.playhead.play()
  }

  setGain(gain: number): void {
    this.gain = gain
    this.tree?.sway?.setGain(gain)
  }

  /** Play nothing from now on, until it is asked to: the processor draws too slowly. */
  calm(): void {
    this.isCalm = true
    if (this.wanted === undefined) this.apply(false)
    this.playhead.pause()
  }

  /** Show the tree at the playhead's place, after some seconds; returns whether anything moves. */
  step(elapsed: number): boolean {
    const sway = this.tree?.sway
    if (!sway || this.animation === null) return false
    return sway.show(this.playhead.seconds, elapsed) || this.playhead.playing
  }

  private apply(gradually: boolean): void {
    const { tree, animation } = this
    tree?.sway?.choose(animation, gradually)
    this.playhead.setSpan('tree', tree?.sway && animation !== null ? spanOf(tree.sway, animation, tree.motion) : null)
  }
}

/** Return what an animation of a tree plays; only that which was measured has the frames of a clip. */
function spanOf(sway: Sway, animation: string, motion: MotionInfo | null): Span {
  const seconds = sway.lengthOf(animation)
  if (animation !== MEASURED || !motion) return { seconds }
  return { seconds, frames: motion.frames, framesPerSecond: motion.frames_per_second }
}
