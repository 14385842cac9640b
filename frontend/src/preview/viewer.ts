import type { Grown } from '../api/types'
import { Ageing } from './ageing'
import { photoRect, type Viewport } from './camera'
import type { Content } from './content'
import { modelContent } from './model'
import { Rig } from './rig'
import { skeletonContent } from './skeletons'
import { thriftyRatio } from './software'
import { Stage } from './stage'
import type { PreviewStatus, View } from './status'
import { aspectOf, openingPose, poseOf } from './views'
import { Wipe } from './wipe'

/** What the viewer is told from outside. */
export interface ViewerOptions {
  software: boolean
  /** Whether the first frames are not to be asked what they say of it. */
  certain: boolean
  label: string
  reducedMotion: () => boolean
  onStatus: (status: PreviewStatus) => void
}

const FLIGHT = 0.9
const NUDGE = 0.16
const GROWTH = 2.5
const LEAFING = 0.6
/** What blows in a tree that has wind until something else is chosen, where frames are quick and motion is welcome. */
const FIRST_WIND = 'breeze'
/** A frame that takes longer than this, in milliseconds, is drawn by a processor, whatever it calls itself. */
const SLOW = 150
/** Frames with a tree in them that are timed; the first compiles the shaders. */
const TIMED = 3
/** Rest, in milliseconds, before the picture is drawn with all its pixels. */
const REST = 160

/** Shows a tree on a stage through the rig's camera, with the photo's wipe; draws only when something changed. */
export class Viewer {
  private readonly stage: Stage
  private readonly rig: Rig
  private readonly wiped: Wipe
  private readonly dusk = matchMedia('(prefers-color-scheme: dark)')
  private readonly watch = new ResizeObserver(() => this.resized())
  private room: Viewport = { width: 0, height: 0 }
  private content: Content | null = null
  private readonly ageing = new Ageing(share => this.aged(share))
  private latest = 0
  private seen: View | 'free' = 'free'
  private leaves = true
  private wind: string | null
  private lost = false
  private software: boolean
  private frames = 0
  private timed = 0
  private pending = 0
  private resting: ReturnType<typeof setTimeout> | undefined
  private last: number | null = null
  private told = ''

  constructor(
    private readonly host: HTMLElement,
    private readonly canvas: HTMLCanvasElement,
    private readonly options: ViewerOptions,
  ) {
    this.software = options.software
    this.wind = options.reducedMotion() || options.software ? null : FIRST_WIND
    if (options.certain) this.timed = TIMED
    this.stage = new Stage(canvas, this.software)
    this.rig = new Rig(canvas, {
      still: options.reducedMotion,
      damped: () => !this.software && !options.reducedMotion(),
      onTurn: () => this.turned(),
      onShift: () => this.ask(),
    })
    this.wiped = new Wipe(host, options.label)
    canvas.addEventListener('webglcontextlost', this.onLost)
    canvas.addEventListener('webglcontextrestored', this.onRestored)
    this.dusk.addEventListener('change', this.onDusk)
    this.stage.paint(this.dusk.matches)
    this.watch.observe(host)
    this.tell()
  }

  showPhoto(url: string | null): void {
    this.wiped.show(url)
    this.ask()
  }

  showLive(grown: Grown): void {
    this.ageing.stop()
    this.stand(skeletonContent(grown, this.stage.shades))
    this.content!.age(1)
    this.tell()
  }

  playGrowth(grown: Grown): Promise<void> {
    this.showLive(grown)
    return this.ageIn(GROWTH)
  }

  async showModel(glb: ArrayBuffer): Promise<void> {
    const turn = ++this.latest
    const content = await modelContent(glb, this.stage.shades, this.stage.edges)
    if (turn !== this.latest) return content.dispose()
    const first = this.content?.kind !== 'model'
    this.ageing.stop()
    this.stand(content)
    content.age(1)
    if (first) this.view('photo')
    await this.ageIn(LEAFING)
  }

  clear(): void {
    this.ageing.stop()
    this.latest++
    this.content = null
    this.stage.show(null)
    this.tell()
    this.ask()
  }

  /** Stop, and free what is held on the GPU; nothing can be shown from now on. */
  end(): void {
    this.clear()
    cancelAnimationFrame(this.pending)
    clearTimeout(this.resting)
    this.watch.disconnect()
    this.dusk.removeEventListener('change', this.onDusk)
    this.canvas.removeEventListener('webglcontextlost', this.onLost)
    this.rig.end()
    this.stage.end()
  }

  view(name: View): void {
    if (!this.content) return
    this.seen = name
    this.rig.fly(poseOf(name, this.content, this.room), FLIGHT)
    this.tell()
    this.ask()
  }

  turnLeaves(on = !this.leaves): void {
    this.leaves = on
    this.leaf()
    this.tell()
    this.ask()
  }

  blow(wind: string | null): void {
    this.wind = wind
    this.catchWind()
    this.stage.relight()
    this.tell()
    this.ask()
  }

  orbit(azimuth: number, polar: number): void {
    const { goal } = this.rig
    const tilted = Math.min(Math.max(goal.polar + polar, 0.03), Math.PI / 2)
    this.rig.fly({ ...goal, azimuth: goal.azimuth + azimuth, polar: tilted }, NUDGE)
    this.turned()
    this.ask()
  }

  zoom(factor: number): void {
    const { goal } = this.rig
    this.rig.fly({ ...goal, size: Math.min(Math.max(goal.size / factor, 0.06), 5) }, NUDGE)
    this.ask()
  }

  /** The picture as it is seen, at twice the CSS pixels or more. */
  png(): Promise<Blob> {
    if (this.lost) return Promise.reject(new Error('The WebGL context is lost.'))
    const scale = Math.max(2, devicePixelRatio)
    this.stage.size(this.room, scale)
    this.stage.draw(this.rig)
    const sheet = new OffscreenCanvas(this.canvas.width, this.canvas.height)
    const pen = sheet.getContext('2d')!
    pen.drawImage(this.canvas, 0, 0)
    this.wiped.draw(pen, scale)
    this.ask()
    return sheet.convertToBlob({ type: 'image/png' })
  }

  /** Put a tree in the place of the last; the first opens the view. */
  private stand(content: Content): void {
    const opens = this.content === null
    this.latest++
    this.content = content
    this.stage.show(content)
    this.leaf()
    this.catchWind()
    if (opens) this.rig.stand(openingPose(content, this.room))
    if (opens) this.seen = 'free'
    this.ask()
  }

  /** Let what is shown move in the wind that was chosen, or in the first that it has. */
  private catchWind(): void {
    const sway = this.content?.sway
    if (!sway) return
    if (this.wind !== null && !sway.winds.includes(this.wind)) this.wind = sway.winds[0] ?? null
    sway.blow(this.wind)
  }

  private leaf(): void {
    const leaves = this.content?.leaves
    if (leaves) leaves.visible = this.leaves
    this.stage.shades.canopy.value = leaves && !this.leaves ? 0 : 1
    this.stage.relight()
  }

  /** Let what is shown grow, where it is seen. */
  private async ageIn(seconds: number): Promise<void> {
    const unseen = this.lost || document.hidden || !this.room.width || !this.room.height
    if (unseen || this.options.reducedMotion()) return
    const grown = this.ageing.start(seconds)
    this.tell()
    this.ask()
    await grown
  }

  private aged(share: number): void {
    this.content?.age(share)
    if (share === 1 || !this.software) this.stage.relight()
    if (share === 1) this.tell()
    this.ask()
  }

  private turned(): void {
    this.seen = 'free'
    this.tell()
  }

  private resized(): void {
    this.room = { width: this.host.clientWidth, height: this.host.clientHeight }
    if (!this.room.width || !this.room.height) return
    this.rig.resize(aspectOf(this.room))
    if (this.content && this.seen !== 'free') this.rig.stand(poseOf(this.seen, this.content, this.room))
    this.ask()
  }

  /** Draw soon. */
  private ask(): void {
    if (!this.pending) this.pending = requestAnimationFrame(now => this.frame(now))
  }

  private frame(now: number): void {
    this.pending = 0
    if (this.lost || !this.room.width || !this.room.height) return
    const seconds = this.last === null ? 1 / 60 : Math.min((now - this.last) / 1000, 0.25)
    const moved = this.rig.step(seconds)
    const blown = this.blown(seconds)
    const moving = this.ageing.step(seconds) || moved || blown
    this.last = moving ? now : null
    this.draw(moving)
    if (moving) this.ask()
  }

  /** Let the wind blow on; says whether it does. A processor has no time for shadows that move with it. */
  private blown(seconds: number): boolean {
    const moves = this.content?.sway?.step(seconds) ?? false
    if (moves && !this.software) this.stage.relight()
    return moves
  }

  private draw(moving: boolean): void {
    this.stage.size(this.room, this.ratio(moving))
    const start = performance.now()
    const calls = this.stage.draw(this.rig)
    if (!this.software && this.content && this.timed++ < TIMED) this.time(start)
    this.frames++
    Object.assign(this.host.dataset, { calls: String(calls), frames: String(this.frames) })
    const rect = this.content && this.rig.facesPhoto ? photoRect(this.rig.pose, this.content.photo, this.room) : null
    this.wiped.place(rect, this.room)
    clearTimeout(this.resting)
    if (moving && this.software) this.resting = setTimeout(() => this.ask(), REST)
  }

  private ratio(moving: boolean): number {
    if (this.software) return thriftyRatio(this.room, moving)
    return Math.min(devicePixelRatio, 2)
  }

  /** A GPU that is none is found out by its first frames. */
  private time(start: number): void {
    this.stage.finish()
    if (this.timed === 1 || performance.now() - start < SLOW) return
    this.software = true
    this.stage.setSoftware(true)
    this.blow(null)
    this.tell()
    this.ask()
  }

  private tell(): void {
    const shows = this.ageing.running && this.content?.kind === 'live' ? 'growing' : (this.content?.kind ?? 'empty')
    const webgl = this.lost ? 'lost' : this.software ? 'software' : 'ok'
    const { leaves, seen: view, content } = this
    const [triangles, winds] = [content?.triangles ?? 0, content?.sway?.winds ?? []]
    const status: PreviewStatus = {
      webgl,
      view,
      shows,
      leaves,
      triangles,
      winds,
      wind: winds.length ? this.wind : null,
    }
    this.host.dataset.state = shows
    if (this.told === JSON.stringify(status)) return
    this.told = JSON.stringify(status)
    this.options.onStatus(status)
  }

  private readonly onLost = (event: Event): void => {
    event.preventDefault()
    this.lost = true
    this.tell()
  }

  private readonly onRestored = (): void => {
    this.lost = false
    this.stage.relight()
    this.tell()
    this.ask()
  }

  private readonly onDusk = (): void => {
    this.stage.paint(this.dusk.matches)
    this.ask()
  }
}
