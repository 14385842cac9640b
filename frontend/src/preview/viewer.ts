import type { Grown } from '../api/types'
import type { Playhead } from '../playhead'
import { CaptureLayer } from './capture/layer'
import type { Measured, Part } from './capture/measured'
import { listenToClicks } from './clicks'
import type { Content } from './content'
import { type EditEvents, type Editing, EditLayer } from './edit/editLayer'
import { GrowthAnimation } from './growthAnimation'
import { liveTreeContent } from './liveTree'
import { Look } from './look'
import { modelContent } from './model'
import { Motion } from './motion'
import { Pace } from './pace'
import { Rig } from './rig'
import { Stage } from './stage'
import type { PreviewStatus, View } from './status'
import { Wipe } from './wipe'

export interface ViewerOptions {
  /** Whether the processor draws WebGL. */
  software: boolean
  /** Whether `software` was set by the page; otherwise the first frames are timed to check it. */
  softwareIsKnown: boolean
  /** The wipe's name, for screen readers. */
  label: string
  reducedMotion: () => boolean
  /** The place in time of what moves. */
  playhead: Playhead
  onStatus: (status: PreviewStatus) => void
  /** Called with the name of the photo whose camera was clicked on. */
  onPhoto: (photo: string) => void
  edits: EditEvents
}

/** Durations in seconds: the growth of branches, that of leaves. */
const GROWTH = 2.5
const LEAF_GROWTH = 0.6
/** How much a photo grows by each px that the wheel turns, as a logarithm. */
const WHEEL_RATE = 0.0015
/** How long nothing must move before the picture is drawn at full resolution, ms. */
const REST = 160

/** Draws a tree on a stage, seen by the rig's camera, with the photo's wipe; only when something has changed. */
export class Viewer {
  private readonly stage: Stage
  private readonly rig: Rig
  private readonly capture = new CaptureLayer(() => this.requestFrame())
  private readonly look: Look
  private readonly wipe: Wipe
  private readonly edit: EditLayer
  private readonly darkScheme = matchMedia('(prefers-color-scheme: dark)')
  private readonly listening = new AbortController()
  private readonly resizing = new ResizeObserver(() => this.onResize())
  private content: Content | null = null
  private readonly growth = new GrowthAnimation(share => this.showGrowth(share))
  /** Counts contents, so that a model that was read too late is not shown. */
  private contentCount = 0
  private leaves = true
  private lost = false
  private readonly pace: Pace
  private readonly motion: Motion
  private frames = 0
  private pendingFrame = 0
  private restTimer: ReturnType<typeof setTimeout> | undefined
  private lastFrameTime: number | null = null
  private lastStatus = ''

  constructor(
    private readonly host: HTMLElement,
    private readonly canvas: HTMLCanvasElement,
    private readonly options: ViewerOptions,
  ) {
    const { software, playhead } = options
    this.pace = new Pace(software, options.softwareIsKnown)
    this.motion = new Motion(playhead, software || options.reducedMotion())
    this.stage = new Stage(canvas, software, this.capture)
    this.rig = new Rig(canvas, {
      reducedMotion: options.reducedMotion,
      damped: () => !this.pace.software && !options.reducedMotion(),
      onTurn: () => this.look.leaveView(),
      onMove: () => this.requestFrame(),
    })
    this.look = new Look(this.rig, this.capture, () => this.onLook())
    this.wipe = new Wipe(host, options.label)
    const { signal } = this.listening
    signal.addEventListener(
      'abort',
      playhead.watch(() => this.requestFrame()),
    )
    this.edit = new EditLayer(host, canvas, options.edits, {
      changed: () => this.requestFrame(),
      pan: (across, down) => this.look.pan(across, down),
      signal,
    })
    listenToClicks(canvas, signal, place => this.onClick(place))
    // Before the rig's own listener, which would move the camera away from the photo's.
    host.addEventListener('wheel', event => this.onWheel(event), { capture: true, passive: false, signal })
    canvas.addEventListener('webglcontextlost', this.onLost, { signal })
    canvas.addEventListener('webglcontextrestored', this.onRestored, { signal })
    this.darkScheme.addEventListener('change', this.onScheme, { signal })
    this.stage.paint(this.darkScheme.matches)
    this.resizing.observe(host)
    this.reportStatus()
  }

  showPhoto(url: string | null): void {
    this.wipe.show(url)
    this.requestFrame()
  }

  showFilm(canvas: HTMLCanvasElement | null): void {
    this.wipe.showFilm(canvas)
    this.requestFrame()
  }

  showMeasured(measured: Measured | null): void {
    const wasEmpty = this.capture.isEmpty
    this.capture.show(measured)
    if (!this.content && wasEmpty !== this.capture.isEmpty) this.look.open()
    this.look.follow()
  }

  setPictures(pictures: ReadonlyMap<string, string>): void {
    this.capture.setPictures(pictures)
    this.requestFrame()
  }

  /** Mark a photo of many; one who looks from a photo flies there. */
  choosePhoto(photo: string | null): void {
    if (photo === this.capture.chosen) return
    this.capture.choose(photo)
    if (this.look.isFromPhoto) this.look.fly('photo')
    this.onLook()
  }

  setPart(part: Part, shown: boolean): void {
    this.capture.setPart(part, shown)
    this.onLook()
  }

  /** Edit branches in place of the tree, or over the whole photo that one looks from; null shows the tree again. */
  setEditing(editing: Editing | null): void {
    if (editing && !this.edit.isOn) this.wipe.set(0)
    this.edit.set(editing)
    this.stage.setTreeShown(editing === null)
    this.capture.setEdited(editing !== null)
    this.onLook()
  }

  showLive(grown: Grown): void {
    this.growth.stop()
    this.setContent(liveTreeContent(grown, this.stage.uniforms))
    this.content!.showGrowth(1)
    this.reportStatus()
  }

  playGrowth(grown: Grown): Promise<void> {
    this.showLive(grown)
    return this.animateGrowth(GROWTH)
  }

  async showModel(glb: ArrayBuffer): Promise<void> {
    const count = ++this.contentCount
    const content = await modelContent(glb, this.stage.uniforms, this.stage.antialiased)
    if (count !== this.contentCount) return content.dispose()
    const first = this.content?.kind !== 'model'
    this.growth.stop()
    this.setContent(content)
    content.showGrowth(1)
    if (first) this.view('photo')
    await this.animateGrowth(LEAF_GROWTH)
  }

  clear(): void {
    this.growth.stop()
    this.contentCount++
    this.content = null
    this.motion.show(null)
    this.stage.show(null)
    this.look.at(null)
  }

  /** Stop, and free what is held on the GPU; nothing can be shown from now on. */
  end(): void {
    this.clear()
    cancelAnimationFrame(this.pendingFrame)
    clearTimeout(this.restTimer)
    this.resizing.disconnect()
    this.listening.abort()
    this.rig.end()
    this.stage.end()
  }

  view(name: View): void {
    this.look.fly(name)
  }

  toggleLeaves(): void {
    this.setLeaves(!this.leaves)
  }

  setLeaves(on: boolean): void {
    this.leaves = on
    this.applyLeaves()
    this.reportStatus()
    this.requestFrame()
  }

  /** Play an animation of the tree, by its name; null for none. */
  setAnimation(name: string | null): void {
    this.motion.choose(name)
    this.stage.updateShadow()
    this.onLook()
  }

  setGain(gain: number): void {
    this.motion.setGain(gain)
    this.onLook()
  }

  orbit(azimuth: number, polar: number): void {
    this.look.orbit(azimuth, polar)
  }

  zoom(factor: number): void {
    this.look.zoom(factor)
  }

  /** Return what is shown as a PNG, with at least two pixels per CSS px. */
  png(): Promise<Blob> {
    if (this.lost) return Promise.reject(new Error('The WebGL context is lost.'))
    const scale = Math.max(2, devicePixelRatio)
    this.stage.size(this.look.viewport, scale)
    this.stage.draw(this.rig)
    const picture = new OffscreenCanvas(this.canvas.width, this.canvas.height)
    const ctx = picture.getContext('2d')!
    ctx.drawImage(this.canvas, 0, 0)
    this.wipe.draw(ctx, scale)
    this.requestFrame()
    return picture.convertToBlob({ type: 'image/png' })
  }

  /** Show a tree in place of the last one; for the first one the camera moves to the opening view. */
  private setContent(content: Content): void {
    this.contentCount++
    this.content = content
    this.stage.show(content)
    this.applyLeaves()
    this.motion.show(content)
    this.look.at(content)
  }

  private applyLeaves(): void {
    const leaves = this.content?.leaves
    if (leaves) leaves.visible = this.leaves
    this.stage.uniforms.canopy.value = leaves && !this.leaves ? 0 : 1
    this.stage.updateShadow()
  }

  /** Animate the tree's growth, unless it is not visible or the user wants reduced motion. */
  private async animateGrowth(seconds: number): Promise<void> {
    const isHidden = this.lost || document.hidden || !this.hasRoom
    if (isHidden || this.options.reducedMotion()) return
    const grown = this.growth.start(seconds)
    this.reportStatus()
    this.requestFrame()
    await grown
  }

  private showGrowth(share: number): void {
    this.content?.showGrowth(share)
    if (share === 1 || !this.pace.software) this.stage.updateShadow()
    if (share === 1) this.reportStatus()
    this.requestFrame()
  }

  private onLook(): void {
    this.reportStatus()
    this.requestFrame()
  }

  private onClick(place: readonly [number, number]): void {
    const photo = this.capture.photoAt(place, this.rig.pose, this.look.viewport)
    if (this.edit.isOn) this.edit.click(place)
    else if (photo) this.options.onPhoto(photo)
  }

  private onWheel(event: WheelEvent): void {
    if (!this.rig.holds) return
    event.preventDefault()
    event.stopPropagation()
    const { left, top } = this.host.getBoundingClientRect()
    this.look.zoom(Math.exp(-event.deltaY * WHEEL_RATE), [event.clientX - left, event.clientY - top])
  }

  private onResize(): void {
    this.look.resize({ width: this.host.clientWidth, height: this.host.clientHeight })
    this.requestFrame()
  }

  /** Draw in the next frame. */
  private requestFrame(): void {
    if (!this.pendingFrame) this.pendingFrame = requestAnimationFrame(now => this.frame(now))
  }

  private frame(now: number): void {
    this.pendingFrame = 0
    if (this.lost || !this.hasRoom) return
    const seconds = this.lastFrameTime === null ? 1 / 60 : Math.min((now - this.lastFrameTime) / 1000, 0.25)
    const moved = this.rig.step(seconds)
    const swaying = this.sway(seconds)
    const moving = this.growth.step(seconds) || moved || swaying
    this.lastFrameTime = moving ? now : null
    this.draw(moving)
    if (moving) this.requestFrame()
  }

  /** Move the tree by its animation; returns whether anything moves. The processor is too slow for shadows that move with it. */
  private sway(seconds: number): boolean {
    const moves = this.motion.step(seconds)
    if (moves && !this.pace.software) this.stage.updateShadow()
    return moves
  }

  private draw(moving: boolean): void {
    this.capture.standsInPhoto = this.look.isFromPhoto
    this.stage.size(this.look.viewport, this.pace.pixelRatio(this.look.viewport, moving))
    const start = performance.now()
    const calls = this.stage.draw(this.rig)
    if (this.content && this.pace.isFoundSlow(start, () => this.stage.finish())) this.onSlow()
    this.frames++
    Object.assign(this.host.dataset, { calls: String(calls), frames: String(this.frames) })
    this.edit.draw(this.rig.pose, this.look.viewport, this.capture.toWorld)
    // Over a photo, a pointer that misses a joint must not turn the branches away from it.
    this.rig.grabbable = !(this.edit.isOn && this.rig.holds)
    this.wipe.place(this.look.photoRect(), this.look.viewport)
    clearTimeout(this.restTimer)
    if (moving && this.pace.software) this.restTimer = setTimeout(() => this.requestFrame(), REST)
  }

  private get hasRoom(): boolean {
    return this.look.viewport.width > 0 && this.look.viewport.height > 0
  }

  /** Some renderers do not tell that they use the processor: it draws nothing that moves by itself. */
  private onSlow(): void {
    this.stage.setSoftware(true)
    this.motion.calm()
    this.onLook()
  }

  private reportStatus(): void {
    const without = this.capture.isEmpty ? 'empty' : 'measured'
    const shows = this.growth.running && this.content?.kind === 'live' ? 'growing' : (this.content?.kind ?? without)
    const webgl = this.lost ? 'lost' : this.pace.software ? 'software' : 'ok'
    const { leaves, content } = this
    const { animations, animation, gain } = this.motion
    const status: PreviewStatus = {
      webgl,
      view: this.look.view,
      shows,
      leaves,
      triangles: content?.triangles ?? 0,
      animations,
      animation,
      gain,
      parts: this.capture.shownParts,
      hasPhotoView: this.look.hasPhotoView,
    }
    this.host.dataset.state = shows
    if (this.lastStatus === JSON.stringify(status)) return
    this.lastStatus = JSON.stringify(status)
    this.options.onStatus(status)
  }

  private readonly onLost = (event: Event): void => {
    event.preventDefault()
    this.lost = true
    this.reportStatus()
  }

  private readonly onRestored = (): void => {
    this.lost = false
    this.stage.updateShadow()
    this.reportStatus()
    this.requestFrame()
  }

  private readonly onScheme = (): void => {
    this.stage.paint(this.darkScheme.matches)
    this.requestFrame()
  }
}
