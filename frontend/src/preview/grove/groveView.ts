import {
  Color,
  Frustum,
  Matrix4,
  NeutralToneMapping,
  PerspectiveCamera,
  Scene,
  Sphere,
  Vector3,
  WebGLRenderer,
} from 'three'
import { OrbitControls } from 'three/addons/controls/OrbitControls.js'
import { DARK, LIGHT } from '../backdrop'
import { modelContent } from '../model'
import { probeWebgl, softwarePixelRatio } from '../software'
import { Copies } from './copies'
import { BUDGET, type Detail, detailsOf, type Seen, SOFTWARE_BUDGET } from './detail'
import { Impostors } from './impostors'
import { type Kind, kindOf } from './kind'
import { lightsOf, stillUniforms } from './lit'
import { Meadow } from './meadow'
import { type Planted, plant } from './planting'

/** The most trees of a grove. */
export const MOST_TREES = 200
const SLOPE = 0.36

/** What a frame took. */
export interface Drawn {
  readonly trees: number
  readonly calls: number
  readonly triangles: number
}

/** Shows many copies of a few trees: those close by in full, others simpler, far ones as pictures. Draws only when it changes. */
export class GroveView {
  private readonly renderer: WebGLRenderer
  private readonly scene = new Scene()
  private readonly camera = new PerspectiveCamera((Math.atan(SLOPE) * 360) / Math.PI, 1, 0.1, 4000)
  private readonly controls: OrbitControls
  private readonly resizing = new ResizeObserver(() => this.ask())
  private readonly software = probeWebgl() === 'software'
  private readonly meadow: Meadow
  private kinds: readonly Kind[] = []
  private copies: readonly Readonly<Record<'near' | 'middle', Copies>>[] = []
  private impostors: Impostors | null = null
  private trees: readonly Planted[] = []
  private pending = 0

  constructor(
    private readonly canvas: HTMLCanvasElement,
    private readonly dark: boolean,
    private readonly drawn: (drawn: Drawn) => void,
  ) {
    this.renderer = new WebGLRenderer({ canvas, antialias: !this.software, powerPreference: 'high-performance' })
    this.renderer.toneMapping = NeutralToneMapping
    this.meadow = new Meadow(MOST_TREES, dark)
    this.scene.background = new Color((dark ? DARK : LIGHT).horizon)
    this.scene.add(...lightsOf(dark), ...this.meadow.parts)
    this.controls = new OrbitControls(this.camera, canvas)
    this.controls.maxPolarAngle = 1.53
    this.controls.addEventListener('change', () => this.ask())
    this.resizing.observe(canvas)
  }

  /** Plant a grove of these trees, given their GLBs. */
  async show(glbs: readonly ArrayBuffer[], count: number): Promise<void> {
    const contents = await Promise.all(glbs.map(glb => modelContent(glb, stillUniforms(), !this.software)))
    this.kinds = contents.map(kindOf)
    this.impostors = new Impostors(this.renderer, this.kinds, MOST_TREES, this.dark)
    this.copies = this.kinds.map(({ near, middle }) => ({
      near: new Copies(near, BUDGET.near),
      middle: new Copies(middle, BUDGET.middle),
    }))
    this.scene.add(this.impostors.mesh, ...this.copies.flatMap(({ near, middle }) => [near.group, middle.group]))
    this.plant(count)
  }

  /** Plant so many trees, seen from outside. */
  plant(count: number): void {
    const radii = this.kinds.map(({ radius }) => radius)
    this.trees = plant(count, radii, 1)
    this.meadow.show(this.trees, this.kinds)
    const height = Math.max(...this.kinds.map(kind => kind.height))
    const reach = Math.max(...this.trees.map(({ x, z }) => Math.hypot(x, z))) + height
    this.controls.target.set(0, height * 0.35, 0)
    this.controls.minDistance = height * 0.4
    this.controls.maxDistance = reach * 4
    this.camera.position.set(reach * 0.35, height * 0.35 + reach * 0.3, reach * 1.5)
    this.controls.update()
    this.ask()
  }

  /** Turn the camera by radians. */
  orbit(azimuth: number, polar: number): void {
    const { target } = this.controls
    const arm = this.camera.position
      .clone()
      .sub(target)
      .applyAxisAngle(new Vector3(0, 1, 0), -azimuth)
    const lift = Math.min(Math.max(Math.acos(arm.y / arm.length()) + polar, 0.1), this.controls.maxPolarAngle)
    const flat = Math.hypot(arm.x, arm.z) || 1
    const [out, up] = [Math.sin(lift) * arm.length(), Math.cos(lift) * arm.length()]
    this.camera.position.set(target.x + (arm.x / flat) * out, target.y + up, target.z + (arm.z / flat) * out)
    this.controls.update()
    this.ask()
  }

  /** Move the camera closer by a factor. */
  zoom(factor: number): void {
    const { target, minDistance, maxDistance } = this.controls
    const arm = this.camera.position.clone().sub(target)
    arm.setLength(Math.min(Math.max(arm.length() / factor, minDistance), maxDistance))
    this.camera.position.copy(target).add(arm)
    this.controls.update()
    this.ask()
  }

  /** Free everything: nothing can be drawn any more. */
  end(): void {
    cancelAnimationFrame(this.pending)
    this.resizing.disconnect()
    this.controls.dispose()
    this.impostors?.dispose()
    for (const { near, middle } of this.copies) [near, middle].forEach(one => void one.dispose())
    for (const { content } of this.kinds) content.dispose()
    this.meadow.dispose()
    this.renderer.dispose()
    this.renderer.forceContextLoss()
  }

  private ask(): void {
    this.pending ||= requestAnimationFrame(() => this.draw())
  }

  private draw(): void {
    this.pending = 0
    const [width, height] = [this.canvas.clientWidth, this.canvas.clientHeight]
    if (!width || !height || !this.impostors) return
    const ratio = this.software ? softwarePixelRatio({ width, height }, false) : Math.min(devicePixelRatio, 2)
    this.renderer.setPixelRatio(ratio)
    this.renderer.setSize(width, height, false)
    this.camera.aspect = width / height
    this.camera.updateProjectionMatrix()
    this.camera.updateMatrixWorld()
    this.setDetails(height)
    this.renderer.render(this.scene, this.camera)
    const { calls, triangles } = this.renderer.info.render
    this.drawn({ trees: this.trees.length, calls, triangles })
  }

  /** Choose how each tree is drawn from here; `height` is the canvas's, CSS px. */
  private setDetails(height: number): void {
    const { projectionMatrix, matrixWorldInverse } = this.camera
    const view = new Frustum().setFromProjectionMatrix(
      new Matrix4().multiplyMatrices(projectionMatrix, matrixWorldInverse),
    )
    const seen = this.trees.map(tree => this.seen(tree, view, height))
    const details = detailsOf(seen, this.software ? SOFTWARE_BUDGET : BUDGET)
    const drawn = (detail: Detail) => this.trees.filter((_, at) => details[at] === detail)
    this.impostors!.show(drawn('far'))
    for (const detail of ['near', 'middle'] as const) {
      const trees = drawn(detail)
      this.copies.forEach((copies, kind) => {
        copies[detail].show(trees.filter(tree => tree.kind === kind))
      })
    }
  }

  private seen({ kind, x, z, size }: Planted, view: Frustum, height: number): Seen {
    const high = this.kinds[kind]!.height * size
    const middle = new Vector3(x, high / 2, z)
    const away = Math.max(this.camera.position.distanceTo(middle), 0.1)
    return {
      height: (high * height) / (2 * SLOPE * away),
      isInView: view.intersectsSphere(new Sphere(middle, high)),
    }
  }
}
