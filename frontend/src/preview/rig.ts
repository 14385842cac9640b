import { PerspectiveCamera, Spherical, Vector3 } from 'three'
import { OrbitControls } from 'three/addons/controls/OrbitControls.js'
import { depthRange, eyeOf, interpolate, PHOTO_SLOPE, type Pose, refit, VIEW_SLOPE } from './camera'

/** The smallest and largest height that may be seen at the target, world units. */
const SIZES = [0.06, 5] as const
/** How far from the target anything is drawn, world units. */
const DRAWN_RADIUS = 6
/** How fast the lens changes after turning away from the photo's view, per second. */
const LENS_RATE = 5
/** How far roll and shift may be from none to be taken for none. */
const STRAIGHT = 1e-3
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
  private flight: { from: Pose; to: Pose; hold: boolean; seconds: number; spent: number } | null = null
  private slope = VIEW_SLOPE
  private roll = 0
  private shift: readonly [number, number] = [0, 0]
  /** Whether the camera keeps its roll and shift, as a photo's camera has them, until the pointer moves it. */
  private held = false
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
    const { slope, roll, shift } = this
    const size = 2 * offset.radius * slope
    return {
      target: [target.x, target.y, target.z],
      azimuth: offset.theta,
      polar: offset.phi,
      size,
      slope,
      roll,
      shift,
    }
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

  /** Whether the camera is at rest as it was told to hold. */
  get holds(): boolean {
    return this.held && !this.flight
  }

  /** Let the pointer turn and move the camera, or not. */
  set grabbable(on: boolean) {
    this.controls.enabled = on
  }

  /** Move to a pose at once; `hold` keeps its roll and shift until the pointer moves the camera. */
  moveTo(pose: Pose, hold = false): void {
    this.flight = null
    this.grabbed = false
    this.held = hold
    this.place(pose)
  }

  /** Fly to a pose over some seconds, to hold it there if wanted; at once with reduced motion. */
  fly(to: Pose, seconds: number, hold = false): void {
    this.endDamping()
    this.grabbed = false
    this.held = false
    if (this.options.reducedMotion()) this.moveTo(to, hold)
    else this.flight = { from: this.pose, to, hold, seconds, spent: 0 }
  }

  /** Advance by a time, seconds; returns whether anything moves. */
  step(seconds: number): boolean {
    if (this.flight) return this.advanceFlight(this.flight, seconds)
    if (this.held) return false
    this.controls.enableDamping = this.options.damped()
    this.controls.maxPolarAngle = lowest(this.pose)
    this.controls.update()
    this.camera.rotateZ(this.roll)
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
    if (t === 1) this.moveTo(flight.to, flight.hold)
    return true
  }

  /** Away from a photo's view, bring its lens closer to that of the other views; returns whether it changed. */
  private changeLens(seconds: number): boolean {
    const { slope, roll, shift } = this
    if ((slope === VIEW_SLOPE && !roll && !shift[0] && !shift[1]) || this.facesPhoto) return false
    const remaining = this.options.reducedMotion() ? 0 : Math.exp(-LENS_RATE * seconds)
    const off = [slope - VIEW_SLOPE, roll, ...shift].map(one => one * remaining) as [number, number, number, number]
    const [lens, turn, across, down] = off.some(one => Math.abs(one) > STRAIGHT) ? off : [0, 0, 0, 0]
    this.place({ ...this.pose, slope: VIEW_SLOPE + lens, roll: turn, shift: [across, down] })
    return true
  }

  private onChange(): void {
    this.held = false
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
    this.roll = pose.roll ?? 0
    this.shift = pose.shift ?? [0, 0]
    controls.maxPolarAngle = lowest(pose)
    controls.target.set(...pose.target)
    controls.minDistance = SIZES[0] / 2 / pose.slope
    controls.maxDistance = SIZES[1] / 2 / pose.slope
    camera.position.set(...eyeOf(pose))
    camera.lookAt(controls.target)
    camera.rotateZ(this.roll)
    camera.fov = (Math.atan(pose.slope) * 360) / Math.PI
    const [across, down] = this.shift
    camera.setViewOffset(this.aspect, 1, -across, -down, this.aspect, 1)
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

/** Return how low the camera may go, radians from above: level with its target, or where a photo was taken below that. */
function lowest({ polar }: Pose): number {
  return Math.max(Math.PI / 2, polar)
}
