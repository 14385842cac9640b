import { type AnimationAction, type AnimationClip, AnimationMixer, type Object3D } from 'three'

/** Seconds of the change from one wind to another. */
const CROSS_FADE = 0.6

/** Plays a tree's winds, which are the animation clips of its file. */
export class Sway {
  readonly winds: readonly string[]
  private readonly mixer: AnimationMixer
  private readonly actions: ReadonlyMap<string, AnimationAction>
  private playing: AnimationAction | null = null

  constructor(tree: Object3D, clips: readonly AnimationClip[]) {
    this.mixer = new AnimationMixer(tree)
    this.actions = new Map(clips.map(clip => [clip.name, this.mixer.clipAction(clip)]))
    this.winds = [...this.actions.keys()]
  }

  /** Play a wind, by its name, in place of another; without one the tree stands still at once. */
  setWind(wind: string | null): void {
    const next = (wind === null ? null : this.actions.get(wind)) ?? null
    if (next === this.playing) return
    const before = this.playing
    this.playing = next
    if (!next) this.mixer.stopAllAction()
    else if (!before) next.reset().play()
    else next.reset().crossFadeFrom(before, CROSS_FADE, false).play()
  }

  /** Advance by a time, seconds; returns whether anything moves. */
  step(seconds: number): boolean {
    if (!this.playing) return false
    this.mixer.update(seconds)
    return true
  }

  dispose(): void {
    this.mixer.stopAllAction()
    this.mixer.uncacheRoot(this.mixer.getRoot() as Object3D)
  }
}
