import { PerspectiveCamera, Spherical, Vector3 } from 'three'
import { OrbitControls } from 'three/addons/controls/OrbitControls.js'
import { depthRange, eyeOf, interpolate, PHOTO_SLOPE, type Pose, refit, VIEW_SLOPE } from './camera'

/** The smallest and largest height that may be seen at the target, world units. */
const SIZES = [0.06, 5] as const
/** How far from the target anything is drawn, world units. */
const DRAWN_RADIUS = 6
/** How fast the lens changes after turning away from the photo's view, per second. */
const LENS_RATE = 5
/** Radians from the photo's view that count as turned away. */
const TURNED_AWAY = 0.002

/** The pose before there is a tree. */
const EMPTY: Pose = { target: [0, 0.4, 0], azimuth: 0, polar: 1.4, size: 1.2, slope: VIEW_SLOPE }

/** How the rig moves, and its listeners. */
export interface RigOptions {
  /** Whether the camera jumps instead of flying. */
  reducedMotion: () => boolean
  /** Whether turning slows down gradually after the pointer is released. */
  damped: () => boolean
  /** Called when the user turns away from a view. */
  onTurn: () => void
  /** Called when the pointer has moved the camera, so that a frame is needed. */
  onMove: () => void
}

/** The one camera: the pointer orbits it, it flies between views, and its lens changes with them. */
export class Rig {
  readonly camera = new PerspectiveCamera()
  private readonly controls: OrbitControls
  private flight: { from: Pose; to: Pose; seconds: number; spent: number } | null = null
  private slope = VIEW_SLOPE
  private aspect = 1
  /** Whether the pointer has grabbed the camera since the last flight. */
  private grabbed = false
  private moved = false

  constructor(
    canvas: HTMLElement,
    private readonly options: RigOptions,
  ) {
    this.controls = new OrbitControls(this.camera, canvas)
    this.controls.minPolarAngle = 0.03
    this.controls.maxPolarAngle = Math.PI / 2
    this.controls.maxTargetRadius = 4
    this.controls.dampingFactor = 0.09
    this.controls.zoomSpeed = 1.4
    this.controls.addEventListener('start', () => this.onGrab())
    this.controls.addEventListener('change', () => this.onChange())
    this.place(EMPTY)
  }

  /** Stop listening to the pointer. */
  end(): void {
    this.controls.dispose()
  }

  /** The camera's pose now. */
  get pose(): Pose {
    const { target } = this.controls
    const offset = new Spherical().setFromVector3(new Vector3().subVectors(this.camera.position, target))
    const size = 2 * offset.radius * this.slope
    return { target: [target.x, target.y, target.z], azimuth: offset.theta, polar: offset.phi, size, slope: this.slope }
  }

  /** The pose that the camera flies to, or its pose now. */
  get goal(): Pose {
    return this.flight?.to ?? this.pose
  }

  /** Whether the camera is at rest in the photo's view, straight ahead. */
  get facesPhoto(): boolean {
    const { azimuth, polar } = this.pose
    return !this.flight && this.slope === PHOTO_SLOPE && Math.hypot(azimuth, polar - Math.PI / 2) < TURNED_AWAY
  }

  /** Move to a pose at once. */
  moveTo(pose: Pose): void {
    this.flight = null
    this.grabbed = false
    this.place(pose)
  }

  /** Fly to a pose over some seconds; at once with reduced motion. */
  fly(to: Pose, seconds: number): void {
    this.endDamping()
    this.grabbed = false
    if (this.options.reducedMotion()) this.moveTo(to)
    else this.flight = { from: this.pose, to, seconds, spent: 0 }
  }

  /** Advance by a time, seconds; returns whether anything moves. */
  step(seconds: number): boolean {
    if (this.flight) return this.advanceFlight(this.flight, seconds)
    this.controls.enableDamping = this.options.damped()
    this.controls.update()
    const { moved } = this
    this.moved = false
    if (moved && this.grabbed && !this.facesPhoto) this.options.onTurn()
    return this.changeLens(seconds) || moved
  }

  /** Fit a viewport of this aspect, width / height. */
  resize(aspect: number): void {
    const pose = refit(this.pose, this.aspect, aspect)
    this.aspect = aspect
    this.place(pose)
  }

  private advanceFlight(flight: NonNullable<Rig['flight']>, seconds: number): boolean {
    flight.spent = Math.min(flight.spent + seconds, flight.seconds)
    const t = flight.spent / flight.seconds
    this.place(interpolate(flight.from, flight.to, t < 0.5 ? 4 * t ** 3 : 1 - (2 - 2 * t) ** 3 / 2))
    if (t === 1) this.moveTo(flight.to)
    return true
  }

  /** Away from the photo's view, bring its long lens closer to that of the other views; returns whether it changed. */
  private changeLens(seconds: number): boolean {
    if (this.slope === VIEW_SLOPE || this.facesPhoto) return false
    const remaining = this.options.reducedMotion() ? 0 : Math.exp(-LENS_RATE * seconds)
    const slope = VIEW_SLOPE + (this.slope - VIEW_SLOPE) * remaining
    this.place({ ...this.pose, slope: VIEW_SLOPE - slope < 1e-3 ? VIEW_SLOPE : slope })
    return true
  }

  private onChange(): void {
    this.moved = true
    this.options.onMove()
  }

  private onGrab(): void {
    this.grabbed = true
    if (!this.flight) return
    this.flight = null
    this.options.onTurn()
  }

  /** End a movement that damping would continue. */
  private endDamping(): void {
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
    this.setDepthRange()
  }

  /** Set the near and far planes close around what can be seen. */
  setDepthRange(): void {
    const [near, far] = depthRange(this.pose, DRAWN_RADIUS)
    this.camera.near = near
    this.camera.far = far
    this.camera.updateProjectionMatrix()
  }
}
