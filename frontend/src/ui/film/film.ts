import { frameUrl, videoUrl } from '../../api/addresses'
import type { Playhead } from '../../playhead'
import type { Clip } from '../../state'
import { followPlayhead } from '../parts/usePlayhead'
import { FrameLoader, type Still } from './frameLoader'

/** How far the video may be from the playhead while it plays, seconds, before it is set to its place. */
const DRIFT = 0.15

/**
 * Shows the frame of a clip that the playhead is at: by the browser's own player, or frame by frame from the service where
 * the browser cannot play the file.
 */
export class Film {
  private readonly video = document.createElement('video')
  private frames: FrameLoader | null = null
  private readonly listeners = new Set<() => void>()
  private readonly endFollowing: () => void
  private ended = false

  constructor(
    private readonly clip: Clip & { readonly id: string },
    private readonly playhead: Playhead,
    file: File | null,
  ) {
    const { frames, frames_per_second: framesPerSecond } = clip
    playhead.setSpan('clip', { seconds: frames / framesPerSecond, frames, framesPerSecond })
    const { video } = this
    Object.assign(video, { muted: true, playsInline: true, preload: 'auto' })
    video.addEventListener('error', () => this.showFrames())
    video.addEventListener('loadeddata', () => this.onLoaded())
    video.addEventListener('seeked', () => this.tell())
    video.src = file ? URL.createObjectURL(file) : videoUrl(clip.id)
    this.endFollowing = followPlayhead(playhead, () => this.follow())
  }

  /** The frame that is shown; null before the first has come. */
  get still(): Still | null {
    if (this.frames) return this.frames.still
    const { video } = this
    if (video.readyState < HTMLMediaElement.HAVE_CURRENT_DATA) return null
    return { image: video, width: video.videoWidth, height: video.videoHeight }
  }

  /** Call a listener whenever another frame is shown; returns a function that ends this. */
  watch(listener: () => void): () => void {
    this.listeners.add(listener)
    return () => this.listeners.delete(listener)
  }

  /** Stop, and free the video. */
  end(): void {
    this.ended = true
    this.endFollowing()
    this.playhead.setSpan('clip', null)
    if (this.video.src.startsWith('blob:')) URL.revokeObjectURL(this.video.src)
    this.video.removeAttribute('src')
    this.video.load()
  }

  /** Show the playhead's frame; while it leads back to the first frame, the last one stays. */
  private follow(): void {
    const { playhead, video, clip } = this
    this.frames?.show(playhead.frame ?? clip.frames - 1)
    if (this.frames) return
    const isFilmed = playhead.span?.frames !== undefined
    if (!isFilmed || video.readyState < HTMLMediaElement.HAVE_METADATA) return
    const end = (clip.frames - 0.5) / clip.frames_per_second
    const place = Math.min(playhead.seconds, end)
    const plays = playhead.playing && place < end
    if (plays) this.run(place)
    else this.hold(place)
    this.tell()
  }

  private run(place: number): void {
    const { video, playhead } = this
    video.playbackRate = playhead.speed
    if (video.paused && !video.ended) void video.play().catch(() => {}) // paused again before it began
    if (Math.abs(video.currentTime - place) > DRIFT && !video.seeking) video.currentTime = place
  }

  private hold(place: number): void {
    const { video } = this
    if (!video.paused) video.pause()
    const isThere = Math.abs(video.currentTime - place) < 0.25 / this.clip.frames_per_second
    if (!isThere && !video.seeking) video.currentTime = place
  }

  /** A file whose sound alone is understood has no size. */
  private onLoaded(): void {
    if (!this.video.videoWidth) this.showFrames()
    else this.follow()
  }

  private showFrames(): void {
    if (this.frames || this.ended) return
    const { clip } = this
    this.frames = new FrameLoader(
      frame => frameUrl(clip.id, frame, FrameLoader.HEIGHT),
      clip.frames,
      () => this.tell(),
    )
    this.follow()
  }

  private tell(): void {
    for (const listener of this.listeners) listener()
  }
}
