import { PerspectiveCamera, Spherical, Vector3 } from 'three'
import { OrbitControls } from 'three/addons/controls/OrbitControls.js'
import { between, depthRange, eyeOf, PHOTO_SLOPE, type Pose, refit, VIEW_SLOPE } from './camera'

/** The smallest and largest height, in world units, that may be seen at the target. */
const SIZES = [0.06, 5] as const
/** How far, in world units, things reach from the target. */
const REACH = 6
/** How fast the lens eases when one turns away from the photo, per second. */
const EASE = 5
/** Radians off the photo's view that count as turning away. */
const AWAY = 0.002

/** Where one stands before there is a tree. */
const EMPTY: Pose = { target: [0, 0.4, 0], azimuth: 0, polar: 1.4, size: 1.2, slope: VIEW_SLOPE }

/** How the rig moves and whom it tells. */
export interface Motion {
  /** Whether flights are left out. */
  still: () => boolean
  /** Whether turning runs on after the pointer let go. */
  damped: () => boolean
  /** The user turns away from the view that was flown to. */
  onTurn: () => void
  /** The pointer moved the camera, so that a frame is wanted. */
  onShift: () => void
}

/** The one camera: orbited by the pointer, flown between views, with a lens that eases. */
export class Rig {
  readonly camera = new PerspectiveCamera()
  private readonly controls: OrbitControls
  private flight: { from: Pose; to: Pose; seconds: number; spent: number } | null = null
  private slope = VIEW_SLOPE
  private aspect = 1
  private held = false
  private shifted = false

  constructor(
    canvas: HTMLElement,
    private readonly motion: Motion,
  ) {
    this.controls = new OrbitControls(this.camera, canvas)
    this.controls.minPolarAngle = 0.03
    this.controls.maxPolarAngle = Math.PI / 2
    this.controls.maxTargetRadius = 4
    this.controls.dampingFactor = 0.09
    this.controls.zoomSpeed = 1.4
    this.controls.addEventListener('start', () => this.grabbed())
    this.controls.addEventListener('change', () => this.shift())
    this.place(EMPTY)
  }

  /** Listen to the pointer no more. */
  end(): void {
    this.controls.dispose()
  }

  /** Where the camera stands now. */
  get pose(): Pose {
    const { target } = this.controls
    const seen = new Spherical().setFromVector3(new Vector3().subVectors(this.camera.position, target))
    const size = 2 * seen.radius * this.slope
    return { target: [target.x, target.y, target.z], azimuth: seen.theta, polar: seen.phi, size, slope: this.slope }
  }

  /** Where the camera is going, or stands. */
  get goal(): Pose {
    return this.flight?.to ?? this.pose
  }

  /** Whether it rests on the photo's parallel view, from straight ahead. */
  get facesPhoto(): boolean {
    const { azimuth, polar } = this.pose
    return !this.flight && this.slope === PHOTO_SLOPE && Math.hypot(azimuth, polar - Math.PI / 2) < AWAY
  }

  /** Stand here at once. */
  stand(pose: Pose): void {
    this.flight = null
    this.held = false
    this.place(pose)
  }

  /** Go there in so many seconds; at once with reduced motion. */
  fly(to: Pose, seconds: number): void {
    this.halt()
    this.held = false
    if (this.motion.still()) this.stand(to)
    else this.flight = { from: this.pose, to, seconds, spent: 0 }
  }

  /** Let time pass; says whether anything moves still. */
  step(seconds: number): boolean {
    if (this.flight) return this.flown(this.flight, seconds)
    this.controls.enableDamping = this.motion.damped()
    this.controls.update()
    const moved = this.shifted
    this.shifted = false
    if (moved && this.held && !this.facesPhoto) this.motion.onTurn()
    return this.easedLens(seconds) || moved
  }

  /** Fit a viewport of this aspect. */
  resize(aspect: number): void {
    const pose = refit(this.pose, this.aspect, aspect)
    this.aspect = aspect
    this.place(pose)
  }

  private flown(flight: NonNullable<Rig['flight']>, seconds: number): boolean {
    flight.spent = Math.min(flight.spent + seconds, flight.seconds)
    const t = flight.spent / flight.seconds
    this.place(between(flight.from, flight.to, t < 0.5 ? 4 * t ** 3 : 1 - (2 - 2 * t) ** 3 / 2))
    if (t === 1) this.stand(flight.to)
    return true
  }

  /** Away from the photo, the long lens gives way to the one of free views. */
  private easedLens(seconds: number): boolean {
    if (this.slope === VIEW_SLOPE || this.facesPhoto) return false
    const left = this.motion.still() ? 0 : Math.exp(-EASE * seconds)
    const slope = VIEW_SLOPE + (this.slope - VIEW_SLOPE) * left
    this.place({ ...this.pose, slope: VIEW_SLOPE - slope < 1e-3 ? VIEW_SLOPE : slope })
    return true
  }

  private shift(): void {
    this.shifted = true
    this.motion.onShift()
  }

  private grabbed(): void {
    this.held = true
    if (!this.flight) return
    this.flight = null
    this.motion.onTurn()
  }

  /** End what damping would still move. */
  private halt(): void {
    if (this.flight) return
    this.controls.enableDamping = false
    this.controls.update()
  }

  private place(pose: Pose): void {
    const { camera, controls } = this
    this.slope = pose.slope
    controls.target.set(...pose.target)
    controls.minDistance = SIZES[0] / 2 / pose.slope
    controls.maxDistance = SIZES[1] / 2 / pose.slope
    camera.position.set(...eyeOf(pose))
    camera.lookAt(controls.target)
    camera.fov = (Math.atan(pose.slope) * 360) / Math.PI
    camera.aspect = this.aspect
    this.focus()
  }

  /** Near and far planes close around what can be seen. */
  focus(): void {
    const [near, far] = depthRange(this.pose, REACH)
    this.camera.near = near
    this.camera.far = far
    this.camera.updateProjectionMatrix()
  }
}
