import {
  type AnimationAction,
  type AnimationClip,
  AnimationMixer,
  type KeyframeTrack,
  type Object3D,
  type Quaternion,
  QuaternionKeyframeTrack,
} from 'three'
import { magnify, meanTurn } from './gain'

/** Seconds of the change from one animation to another. */
const CROSS_FADE = 0.6
/** The animation that follows a video. */
export const MEASURED = 'measured'

/** The rotations of a bone as the file has them, with the track that plays them. */
interface Turns {
  readonly track: KeyframeTrack
  readonly own: Float32Array
  readonly mean: Quaternion
}

/** Shows a tree at a place in one of its animations, which are those of its file. */
export class Sway {
  /** The names of the animations, that which was measured first. */
  readonly animations: readonly string[]
  private readonly mixer: AnimationMixer
  private readonly actions: ReadonlyMap<string, AnimationAction>
  private readonly turns: readonly Turns[]
  private shown: AnimationAction | null = null
  private gain = 1
  private fadeLeft = 0
  private isStale = false

  constructor(tree: Object3D, clips: readonly AnimationClip[]) {
    this.mixer = new AnimationMixer(tree)
    this.turns = clips.flatMap(clip => clip.tracks.filter(isTurning).map(turnsOf))
    const names = clips.map(({ name }) => name)
    this.animations = [...names.filter(name => name === MEASURED), ...names.filter(name => name !== MEASURED)]
    this.actions = new Map(clips.map(clip => [clip.name, this.mixer.clipAction(clip)]))
  }

  /** Return how long an animation is, seconds; 0 where there is none of this name. */
  lengthOf(name: string): number {
    return this.actions.get(name)?.getClip().duration ?? 0
  }

  /** Choose an animation by its name, perhaps gradually; without one the tree stands still at once. */
  choose(name: string | null, gradually: boolean): void {
    const next = (name === null ? null : this.actions.get(name)) ?? null
    if (next === this.shown) return
    const before = this.shown
    this.shown = next
    this.fadeLeft = before && next && gradually ? CROSS_FADE : 0
    this.isStale = true
    if (this.fadeLeft) return void next!.reset().crossFadeFrom(before!, CROSS_FADE, false).play()
    this.mixer.stopAllAction()
    next?.reset().play()
  }

  /** Turn all branches by this factor of how far they turn from their means: 0 is calm, 1 as in the file. */
  setGain(gain: number): void {
    if (gain === this.gain) return
    this.gain = gain
    this.isStale = true
    for (const { track, own, mean } of this.turns) magnify(own, mean, gain, track.values as Float32Array)
  }

  /** Show a place of the animation, after some seconds of the viewer's time; returns whether anything moves. */
  show(place: number, elapsed: number): boolean {
    const { shown } = this
    if (!shown) return false
    const moved = this.isStale || shown.time !== place || this.fadeLeft > 0
    this.isStale = false
    this.fadeLeft = Math.max(this.fadeLeft - elapsed, 0)
    shown.paused = true // its time is set from outside
    shown.time = place
    this.mixer.update(elapsed)
    return moved
  }

  dispose(): void {
    this.mixer.stopAllAction()
    this.mixer.uncacheRoot(this.mixer.getRoot() as Object3D)
  }
}

function isTurning(track: KeyframeTrack): boolean {
  return track instanceof QuaternionKeyframeTrack
}

/** Give a track values of its own, which may be changed: the file's are perhaps shared. */
function turnsOf(track: KeyframeTrack): Turns {
  const own = Float32Array.from(track.values)
  track.values = own.slice()
  return { track, own, mean: meanTurn(own) }
}
