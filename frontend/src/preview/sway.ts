import { type AnimationAction, type AnimationClip, AnimationMixer, type Object3D } from 'three'

/** Seconds over which one wind gives way to another. */
const TURN = 0.6

/** Winds that can be played on a tree: the clips that its file has. */
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

  /** Let a wind blow, by its name; another one gives way to it, and without one the tree comes to rest at once. */
  blow(wind: string | null): void {
    const next = (wind === null ? null : this.actions.get(wind)) ?? null
    if (next === this.playing) return
    const before = this.playing
    this.playing = next
    if (!next) this.mixer.stopAllAction()
    else if (!before) next.reset().play()
    else next.reset().crossFadeFrom(before, TURN, false).play()
  }

  /** Let time pass, seconds; says whether anything moves. */
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
