import { DirectionalLight, HemisphereLight, NeutralToneMapping, PCFShadowMap, Scene, WebGLRenderer } from 'three'
import { Backdrop, DARK, LIGHT, Meadow, type Scheme } from './backdrop'
import { type Box, horizonOf, VIEW_SLOPE, type Viewport } from './camera'
import { type Content, groundUnder, shadowOf } from './content'
import type { Rig } from './rig'
import type { Shades } from './shading'
import { SUN } from './sun'

const SHADOW_SIDE = 2048
const PAINTED_SIDE = 96
/** From here on (0..1) the ground is seen from its edge and would only be a line. */
const LEVEL = 0.99

/** Renderer, light, ground and sky; draws the one content that stands on it. */
export class Stage {
  readonly shades: Shades = { baked: { value: 0 }, canopy: { value: 1 }, leafed: { value: 1 }, age: { value: 0 } }
  readonly renderer: WebGLRenderer
  private readonly scene = new Scene()
  private readonly sun = new DirectionalLight()
  private readonly sky = new HemisphereLight()
  private readonly backdrop = new Backdrop()
  private readonly ground = new Meadow()
  private content: Content | null = null

  constructor(
    canvas: HTMLCanvasElement,
    private software: boolean,
  ) {
    this.renderer = new WebGLRenderer({ canvas, antialias: !software, powerPreference: 'high-performance' })
    this.renderer.info.autoReset = false
    this.renderer.toneMapping = NeutralToneMapping
    this.renderer.shadowMap.enabled = true
    this.renderer.shadowMap.type = PCFShadowMap
    this.renderer.shadowMap.autoUpdate = false
    this.sun.shadow.mapSize.setScalar(SHADOW_SIDE)
    this.sun.shadow.intensity = 0.6
    this.sun.shadow.radius = 2.5
    this.scene.add(this.sun, this.sun.target, this.sky, this.backdrop.mesh, this.ground.mesh)
    this.setSoftware(software)
  }

  /** Whether edges are smoothed by the canvas itself. */
  get edges(): boolean {
    return this.renderer.getContextAttributes().antialias === true
  }

  /** Draw with less: no shadow map, a painted shadow in its place. */
  setSoftware(software: boolean): void {
    this.software = software
    this.sun.castShadow = !software
    this.shades.baked.value = software ? 1 : 0
    this.relight()
  }

  /** Put on the light and the colours of day or dusk. */
  paint(dark: boolean): void {
    const scheme: Scheme = dark ? DARK : LIGHT
    this.backdrop.paint(scheme)
    this.ground.paint(scheme)
    this.sun.color.set(scheme.sun)
    this.sun.intensity = scheme.sunlight
    this.sky.color.set(scheme.sky)
    this.sky.groundColor.set(scheme.meadow)
    this.sky.intensity = scheme.skylight
  }

  /** Let a tree stand here in the place of the last, which is freed. */
  show(content: Content | null): void {
    if (this.content) this.scene.remove(this.content.group)
    this.content?.dispose()
    this.content = content
    if (content) {
      this.scene.add(content.group)
      this.fitSun(content.box)
      this.ground.lie(groundUnder(content.box))
    }
    this.relight()
  }

  /** What throws the shadow has changed. */
  relight(): void {
    this.renderer.shadowMap.needsUpdate = !this.software
    if (this.software && this.content) this.ground.shade(shadowOf(this.content, PAINTED_SIDE), PAINTED_SIDE)
  }

  /** Set the canvas's pixels: `ratio` for each CSS pixel. */
  size({ width, height }: Viewport, ratio: number): void {
    this.renderer.setPixelRatio(ratio)
    this.renderer.setSize(width, height, false)
  }

  /** Draw one frame; gives the number of draw calls. */
  draw(rig: Rig): number {
    rig.focus()
    const level = 1 - rig.pose.slope / VIEW_SLOPE
    this.backdrop.set(horizonOf(rig.pose), level)
    this.ground.mesh.visible = this.content !== null && level < LEVEL
    this.renderer.info.reset()
    this.renderer.render(this.scene, rig.camera)
    return this.renderer.info.render.calls
  }

  /** Free everything; the canvas can be drawn on no more. */
  end(): void {
    this.show(null)
    this.renderer.dispose()
    this.renderer.forceContextLoss()
  }

  /** Wait until the frame is drawn. */
  finish(): void {
    const gl = this.renderer.getContext()
    gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4))
  }

  private fitSun({ min, max }: Box): void {
    const radius = Math.hypot(max[0] - min[0], max[1] - min[1], max[2] - min[2]) / 2
    const { target, shadow } = this.sun
    target.position.set((min[0] + max[0]) / 2, (min[1] + max[1]) / 2, (min[2] + max[2]) / 2)
    this.sun.position
      .set(SUN[0], SUN[1], SUN[2])
      .multiplyScalar(radius * 2)
      .add(target.position)
    const { camera } = shadow
    Object.assign(camera, { left: -radius, right: radius, top: radius, bottom: -radius })
    Object.assign(camera, { near: radius * 0.5, far: radius * 6 })
    camera.updateProjectionMatrix()
    shadow.bias = -0.0012
    shadow.normalBias = 0.006
  }
}
