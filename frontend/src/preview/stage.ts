import { DirectionalLight, HemisphereLight, NeutralToneMapping, PCFShadowMap, Scene, WebGLRenderer } from 'three'
import { Backdrop, DARK, Ground, LIGHT, type Scheme } from './backdrop'
import { type Box, horizonOf, VIEW_SLOPE, type Viewport } from './camera'
import type { CaptureLayer } from './capture/layer'
import { type Content, groundUnder, shadowOf } from './content'
import type { Rig } from './rig'
import type { TreeUniforms } from './shading'
import { SUN } from './sun'

/** Sides of the shadow map and of the baked shadow, px. */
const SHADOW_MAP_SIDE = 2048
const BAKED_SIDE = 96
/** From this share on (0..1) the ground is seen edge-on and would only be a line. */
const EDGE_ON = 0.99

/** Renderer, light, ground and sky; draws one content at a time. */
export class Stage {
  readonly uniforms: TreeUniforms = {
    baked: { value: 0 },
    canopy: { value: 1 },
    leafShare: { value: 1 },
    iteration: { value: 0 },
  }
  readonly renderer: WebGLRenderer
  private readonly scene = new Scene()
  private readonly sun = new DirectionalLight()
  private readonly sky = new HemisphereLight()
  private readonly backdrop = new Backdrop()
  private readonly ground = new Ground()
  private content: Content | null = null
  private treeShown = true

  constructor(
    canvas: HTMLCanvasElement,
    private software: boolean,
    private readonly measured: CaptureLayer,
  ) {
    this.renderer = new WebGLRenderer({ canvas, antialias: !software, powerPreference: 'high-performance' })
    this.renderer.info.autoReset = false
    this.renderer.toneMapping = NeutralToneMapping
    this.renderer.shadowMap.enabled = true
    this.renderer.shadowMap.type = PCFShadowMap
    this.renderer.shadowMap.autoUpdate = false
    this.sun.shadow.mapSize.setScalar(SHADOW_MAP_SIDE)
    this.sun.shadow.intensity = 0.6
    this.sun.shadow.radius = 2.5
    this.scene.add(this.sun, this.sun.target, this.sky, this.backdrop.mesh, this.ground.mesh, measured.group)
    this.setSoftware(software)
  }

  /** Whether the canvas itself is antialiased. */
  get antialiased(): boolean {
    return this.renderer.getContextAttributes().antialias === true
  }

  /** Set whether the processor draws: then a baked shadow takes the place of the shadow map. */
  setSoftware(software: boolean): void {
    this.software = software
    this.sun.castShadow = !software
    this.uniforms.baked.value = software ? 1 : 0
    this.updateShadow()
  }

  /** Set light and colours for the page's light or dark scheme. */
  paint(dark: boolean): void {
    const scheme: Scheme = dark ? DARK : LIGHT
    this.backdrop.paint(scheme)
    this.ground.paint(scheme)
    this.measured.paint(dark)
    this.sun.color.set(scheme.sun)
    this.sun.intensity = scheme.sunlight
    this.sky.color.set(scheme.sky)
    this.sky.groundColor.set(scheme.grass)
    this.sky.intensity = scheme.skylight
  }

  /** Show a tree in place of the last one, which is disposed of. */
  show(content: Content | null): void {
    if (this.content) this.scene.remove(this.content.group)
    this.content?.dispose()
    this.content = content
    if (content) {
      this.scene.add(content.group)
      content.group.visible = this.treeShown
      this.fitSun(content.box)
      this.ground.place(groundUnder(content.box))
    }
    this.updateShadow()
  }

  /** Show the tree, or only its ground. */
  setTreeShown(on: boolean): void {
    if (on === this.treeShown) return
    this.treeShown = on
    if (this.content) this.content.group.visible = on
    this.updateShadow()
  }

  /** Make the shadow again, because the tree has changed. */
  updateShadow(): void {
    this.renderer.shadowMap.needsUpdate = !this.software
    if (this.software && this.content) this.ground.setBakedShadow(shadowOf(this.content, BAKED_SIDE), BAKED_SIDE)
  }

  /** Set the canvas's size (CSS px) and its pixels per CSS px. */
  size({ width, height }: Viewport, ratio: number): void {
    this.renderer.setPixelRatio(ratio)
    this.renderer.setSize(width, height, false)
  }

  /** Draw one frame; returns the number of draw calls. */
  draw(rig: Rig): number {
    rig.setDepthRange()
    // The photo's long lens looks at the ground edge-on.
    const edgeOn = Math.max(1 - rig.pose.slope / VIEW_SLOPE, 0)
    this.backdrop.set(horizonOf(rig.pose), edgeOn)
    this.ground.mesh.visible = this.content !== null && edgeOn < EDGE_ON
    this.renderer.info.reset()
    this.renderer.render(this.scene, rig.camera)
    return this.renderer.info.render.calls
  }

  /** Free everything: nothing can be drawn any more. */
  end(): void {
    this.show(null)
    this.measured.dispose()
    this.renderer.dispose()
    this.renderer.forceContextLoss()
  }

  /** Wait until the frame is drawn: reading a pixel waits for the GPU. */
  finish(): void {
    const gl = this.renderer.getContext()
    gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4))
  }

  /** Make the sun's shadow cover a box. */
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
