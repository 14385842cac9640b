/** How many frames are fetched ahead of the one that is shown. */
const AHEAD = 12
/** How many are fetched at once: one comes after the other over a slow connection. */
const AT_ONCE = 3

/** A picture that can be drawn, with its size, px. */
export interface Still {
  readonly image: CanvasImageSource
  readonly width: number
  readonly height: number
}

/** Fetches the frames of a clip as pictures, those that are shown soon first, and keeps them. */
export class FrameLoader {
  /** The height at which frames are asked for, px. */
  static readonly HEIGHT = 480
  private readonly loaded = new Map<number, HTMLImageElement>()
  private readonly underWay = new Set<number>()
  private wanted = 0
  private shown: HTMLImageElement | null = null

  constructor(
    private readonly addressOf: (frame: number) => string,
    private readonly count: number,
    private readonly changed: () => void,
    private readonly makeImage: () => HTMLImageElement = () => new Image(),
  ) {}

  /** The last wanted frame that has come. */
  get still(): Still | null {
    const { shown } = this
    return shown && { image: shown, width: shown.naturalWidth, height: shown.naturalHeight }
  }

  /** Show a frame, from 0; until it has come, what was shown stays. */
  show(frame: number): void {
    this.wanted = frame
    const ready = this.loaded.get(frame)
    if (ready && ready !== this.shown) {
      this.shown = ready
      this.changed()
    }
    this.fetchNext()
  }

  private fetchNext(): void {
    for (let step = 0; step <= AHEAD && this.underWay.size < AT_ONCE; step++) {
      const frame = (this.wanted + step) % this.count
      if (!this.loaded.has(frame) && !this.underWay.has(frame)) this.fetch(frame)
    }
  }

  private fetch(frame: number): void {
    const image = this.makeImage()
    this.underWay.add(frame)
    image.onload = () => {
      this.loaded.set(frame, image)
      this.end(frame)
    }
    image.onerror = () => this.underWay.delete(frame) // it is asked for again when it is next wanted
    image.src = this.addressOf(frame)
  }

  private end(frame: number): void {
    this.underWay.delete(frame)
    this.show(this.wanted)
  }
}
