import { type Box, type Pose, photoPose, photoRect, type Rect, type Viewport, zoomedLens } from './camera'
import type { CaptureLayer } from './capture/layer'
import type { Content } from './content'
import type { Rig } from './rig'
import type { View } from './status'
import { aspectOf, openingPose, poseOf } from './views'

/** Durations of a flight between views and of one by a key, seconds. */
const FLIGHT = 0.9
const KEY_FLIGHT = 0.16
/** How much larger than whole a photo of many can be shown. */
const MOST_ZOOM = 8

/** From where one looks at what is shown: turns the rig to views and to photos, and follows what is shown. */
export class Look {
  /** The view that was chosen last; `free` once the user has turned away from it. */
  view: View | 'free' = 'free'
  viewport: Viewport = { width: 0, height: 0 }
  private content: Content | null = null

  /** `changed` is called when the view is another one, or another part of it is seen. */
  constructor(
    private readonly rig: Rig,
    private readonly capture: CaptureLayer,
    private readonly changed: () => void,
  ) {}

  /** Whether one looks, or is on the way to look, from one of many photos. */
  get isFromPhoto(): boolean {
    return this.view === 'photo' && !this.capture.isEmpty
  }

  /** Whether there is a photo's view. */
  get hasPhotoView(): boolean {
    return this.poseOf('photo') !== null
  }

  /** Look at another tree, or none; the camera moves where there was nothing to look at before, or is nothing now. */
  at(content: Content | null): void {
    const opens = (content === null) !== (this.content === null)
    this.content = content
    this.capture.place(content)
    if (opens) this.open()
    this.follow()
  }

  /** Turn to what is shown now; one who looks from a photo stays there. */
  open(): void {
    const box = this.box
    if (!box || (this.isFromPhoto && this.rig.holds && this.hasPhotoView)) return
    this.rig.moveTo(openingPose(box, this.viewport, this.content === null))
    this.view = 'free'
  }

  /** Stay with the photo that one looks from, where what was measured has moved. */
  follow(): void {
    const pose = this.isFromPhoto && this.rig.holds ? this.poseOf('photo') : null
    if (pose) this.rig.moveTo(pose, true)
    this.changed()
  }

  /** Fly to a view. */
  fly(name: View): void {
    const pose = this.poseOf(name)
    if (!pose && !this.box) return
    this.view = pose ? name : 'free'
    if (pose) this.rig.fly(pose, FLIGHT, this.isFromPhoto)
    this.changed()
  }

  leaveView(): void {
    this.view = 'free'
    this.changed()
  }

  /** Turn by radians: `azimuth` to the right, `polar` downwards. */
  orbit(azimuth: number, polar: number): void {
    const { goal } = this.rig
    const tilted = Math.min(Math.max(goal.polar + polar, 0.03), Math.PI / 2)
    this.rig.fly({ ...goal, azimuth: goal.azimuth + azimuth, polar: tilted }, KEY_FLIGHT)
    this.leaveView()
  }

  /** Come closer by a factor; from a photo of many, its picture and what is seen there grow about a place, CSS px. */
  zoom(factor: number, about: readonly [number, number] = [this.viewport.width / 2, this.viewport.height / 2]): void {
    const { goal } = this.rig
    if (this.rig.holds) this.zoomPhoto(factor, about)
    else this.rig.fly({ ...goal, size: Math.min(Math.max(goal.size / factor, 0.06), 5) }, KEY_FLIGHT)
    this.changed()
  }

  /** Move the photo that one looks from, with all that is seen there, CSS px; elsewhere nothing moves. */
  pan(across: number, down: number): void {
    if (!this.rig.holds) return
    const { pose } = this.rig
    const [x, y] = pose.shift ?? [0, 0]
    const { height } = this.viewport
    this.rig.moveTo({ ...pose, shift: [x + across / height, y + down / height] }, true)
    this.changed()
  }

  /** Fit another viewport; a view that was chosen is shown whole again. */
  resize(viewport: Viewport): void {
    this.viewport = viewport
    if (!viewport.width || !viewport.height) return
    this.rig.resize(aspectOf(viewport))
    const pose = this.view === 'free' ? null : this.poseOf(this.view)
    if (pose) this.rig.moveTo(pose, this.isFromPhoto)
  }

  /** Return where the photo lies over what is shown, CSS px; null where the camera is not the photo's. */
  photoRect(): Rect | null {
    const { rig, content, viewport } = this
    if (!this.capture.isEmpty) return rig.holds ? this.capture.photoRect(rig.pose, viewport) : null
    return content && rig.facesPhoto ? photoRect(rig.pose, content.photo, viewport) : null
  }

  /** The box around what is shown; null where nothing is. */
  private get box(): Box | null {
    return this.content?.box ?? this.capture.box
  }

  /** Return the pose of a view of what is shown; null where there is none. */
  private poseOf(name: View): Pose | null {
    const { box, content, viewport } = this
    if (name !== 'photo') return box && poseOf(name, box, viewport)
    if (!this.capture.isEmpty) return this.capture.photoPose(viewport)
    return content && photoPose(content.photo, aspectOf(viewport))
  }

  private zoomPhoto(factor: number, about: readonly [number, number]): void {
    const whole = this.poseOf('photo')
    if (!whole) return
    const { pose } = this.rig
    const least = pose.slope / whole.slope
    const zoomed = zoomedLens(pose, Math.min(factor, least * MOST_ZOOM), about, this.viewport)
    this.rig.moveTo(factor <= least ? whole : zoomed, true)
  }
}
