import './preview.css'
import type { Grown } from '../api/types'
import { press } from './keys'
import { probeWebgl } from './software'
import { NOTHING_SHOWN, type PreviewStatus, type View } from './status'
import { Viewer } from './viewer'

export { NOTHING_SHOWN, type PreviewStatus, type View } from './status'

/** The preview's labels, and who is told its status. `software`: whether WebGL is drawn by the processor; found out where absent. */
export interface PreviewOptions {
  labels: { wipe: string; canvas: string }
  reducedMotion: () => boolean
  onStatus: (status: PreviewStatus) => void
  software?: boolean
}

/** The 3D preview in an element of the page. Where there is no WebGL it shows nothing and says so in its status. */
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
    const certain = options.software !== undefined
    this.viewer =
      webgl === 'absent' ? null : this.opened({ ...options, software, certain, label: options.labels.wipe }, options)
    if (!this.viewer) options.onStatus({ ...NOTHING_SHOWN, webgl: 'absent', view: 'free' })
  }

  /** The picture for the wipe, of the upright photo; null takes it away. */
  showPhoto(url: string | null): void {
    this.viewer?.showPhoto(url)
  }

  /** Show the live skeleton; the camera stays where it is, the first tree opens on a view from the side. */
  showLive(grown: Grown): void {
    this.viewer?.showLive(grown)
  }

  /** Play the growth of a skeleton; ends showing all of it. */
  async playGrowth(grown: Grown): Promise<void> {
    await this.viewer?.playGrowth(grown)
  }

  /** Replace what is shown by a GLB of the service; its leaves come in. The first one is flown to the photo's view. */
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

  setLeaves(on: boolean): void {
    this.viewer?.turnLeaves(on)
  }

  /** Let a wind of the file blow, by its name; null for none. */
  blow(wind: string | null): void {
    this.viewer?.blow(wind)
  }

  /** Turn by radians: `azimuth` to the right, `polar` downwards. */
  orbit(azimuth: number, polar: number): void {
    this.viewer?.orbit(azimuth, polar)
  }

  /** Come closer by a factor. */
  zoom(factor: number): void {
    this.viewer?.zoom(factor)
  }

  /** The picture as it is seen, as a PNG of twice its CSS pixels or more. */
  async png(): Promise<Blob> {
    if (!this.viewer) throw new Error('There is no WebGL to draw a picture with.')
    return this.viewer.png()
  }

  /** Leave the page, and free what the preview holds on the GPU. */
  end(): void {
    this.viewer?.end()
    this.host.replaceChildren()
  }

  private opened(options: ConstructorParameters<typeof Viewer>[2], { labels }: PreviewOptions): Viewer | null {
    const { canvas, host } = this
    canvas.className = 'preview-canvas'
    for (const [name, value] of Object.entries({ tabindex: '0', role: 'application', 'aria-label': labels.canvas }))
      canvas.setAttribute(name, value)
    host.prepend(canvas)
    const viewer = new Viewer(host, canvas, options)
    canvas.addEventListener('keydown', event => {
      const bare = !event.ctrlKey && !event.metaKey && !event.altKey
      if (bare && press(event.key, viewer)) event.preventDefault()
    })
    return viewer
  }
}
