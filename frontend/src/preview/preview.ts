import './preview.css'
import type { Grown } from '../api/types'
import type { Playhead } from '../playhead'
import type { Measured, Part } from './capture/measured'
import type { EditEvents, Editing } from './edit/editLayer'
import { pressKey } from './keys'
import { probeWebgl } from './software'
import { NOTHING_SHOWN, type PreviewStatus, type View } from './status'
import { Viewer, type ViewerOptions } from './viewer'

export interface PreviewOptions {
  /** Names of the wipe and of the canvas, for screen readers. */
  labels: { wipe: string; canvas: string }
  reducedMotion: () => boolean
  /** The place in time of what moves. */
  playhead: Playhead
  onStatus: (status: PreviewStatus) => void
  /** Called with the name of the photo whose camera was clicked on, where a tree was measured from many. */
  onPhoto: (photo: string) => void
  /** Called as branches are edited. */
  edits: EditEvents
  /** Whether the processor draws WebGL; found out where absent. */
  software?: boolean
}

/** The 3D preview in an element of the page. Without WebGL it shows nothing, and its status says so. */
export class Preview {
  private readonly viewer: Viewer | null
  private readonly canvas = document.createElement('canvas')

  constructor(
    private readonly host: HTMLElement,
    options: PreviewOptions,
  ) {
    host.classList.add('preview')
    host.dataset.state = 'empty'
    const webgl = probeWebgl()
    const software = options.software ?? webgl === 'software'
    const softwareIsKnown = options.software !== undefined
    const viewerOptions = { ...options, software, softwareIsKnown, label: options.labels.wipe }
    this.viewer = webgl === 'absent' ? null : this.createViewer(viewerOptions, options.labels.canvas)
    if (!this.viewer) options.onStatus({ ...NOTHING_SHOWN, webgl: 'absent', view: 'free' })
  }

  /** Show the upright photo at this address in the wipe; null removes it. */
  showPhoto(url: string | null): void {
    this.viewer?.showPhoto(url)
  }

  /** Show a canvas with a video's frame in the wipe, in the photo's place; null shows the photo again. */
  showFilm(canvas: HTMLCanvasElement | null): void {
    this.viewer?.showFilm(canvas)
  }

  /** Show what many photos say about a tree, beside the tree; null shows none of it. */
  showMeasured(measured: Measured | null): void {
    this.viewer?.showMeasured(measured)
  }

  /** Set the addresses of small pictures of the photos, by their names. */
  setPictures(pictures: ReadonlyMap<string, string>): void {
    this.viewer?.setPictures(pictures)
  }

  /** Mark the photo of this name, whose camera the photo's view is that of. */
  choosePhoto(photo: string | null): void {
    this.viewer?.choosePhoto(photo)
  }

  /** Show or hide a part of what many photos say. */
  setPart(part: Part, shown: boolean): void {
    this.viewer?.setPart(part, shown)
  }

  /** Edit branches in place of the tree; null ends that. */
  setEditing(editing: Editing | null): void {
    this.viewer?.setEditing(editing)
  }

  /** Show the live tree; the camera stays where it is, but the first tree of all is shown from the side. */
  showLive(grown: Grown): void {
    this.viewer?.showLive(grown)
  }

  /** Animate the growth of a live tree; the promise resolves when it is fully grown. */
  async playGrowth(grown: Grown): Promise<void> {
    await this.viewer?.playGrowth(grown)
  }

  /** Show a GLB of the service; its leaves appear gradually. After a live tree the camera flies to the photo's view. */
  async showModel(glb: ArrayBuffer): Promise<void> {
    await this.viewer?.showModel(glb)
  }

  /** Show no tree. */
  clear(): void {
    this.viewer?.clear()
  }

  /** Fly to a view. */
  view(name: View): void {
    this.viewer?.view(name)
  }

  /** Show or hide the leaves. */
  setLeaves(on: boolean): void {
    this.viewer?.setLeaves(on)
  }

  /** Play an animation of the file, by its name; null for none. */
  setAnimation(name: string | null): void {
    this.viewer?.setAnimation(name)
  }

  /** Turn branches by this factor of how far they turn from their means: 0 is calm, 1 as in the file. */
  setGain(gain: number): void {
    this.viewer?.setGain(gain)
  }

  /** Turn the camera by radians: `azimuth` to the right, `polar` downwards. */
  orbit(azimuth: number, polar: number): void {
    this.viewer?.orbit(azimuth, polar)
  }

  /** Move the camera closer by a factor. */
  zoom(factor: number): void {
    this.viewer?.zoom(factor)
  }

  /** Return what is shown as a PNG, with at least two pixels per CSS px. */
  async png(): Promise<Blob> {
    if (!this.viewer) throw new Error('A picture needs WebGL, which this browser does not have.')
    return this.viewer.png()
  }

  /** Remove the preview from the page, and free what it holds on the GPU. */
  end(): void {
    this.viewer?.end()
    this.host.replaceChildren()
  }

  private createViewer(options: ViewerOptions, label: string): Viewer {
    const { canvas, host } = this
    canvas.className = 'preview-canvas'
    for (const [name, value] of Object.entries({ tabindex: '0', role: 'application', 'aria-label': label }))
      canvas.setAttribute(name, value)
    host.prepend(canvas)
    const viewer = new Viewer(host, canvas, options)
    canvas.addEventListener('keydown', event => {
      const plain = !event.ctrlKey && !event.metaKey && !event.altKey
      if (plain && pressKey(event.key, viewer)) event.preventDefault()
    })
    return viewer
  }
}
