/** What can be played: some seconds, of which the first hold the frames of a clip where there is one. */
export interface Span {
  readonly seconds: number
  /** How many frames the clip has; absent for what was not filmed. */
  readonly frames?: number
  readonly framesPerSecond?: number
}

/** What plays: a tree, whose animation goes first, or the clip alone. */
export type Player = 'tree' | 'clip'

/** How slow it may be played; 1 is as it was filmed. */
export const SPEEDS = [0.25, 0.5, 0.75, 1] as const

/** The one place in time that tree, video and scrubber show. It runs by a clock of its own, so that slow frames do not slow it. */
export class Playhead {
  #spans: Readonly<Partial<Record<Player, Span>>> = {}
  #playing = false
  #speed = 1
  /** The place when it was last set, seconds, and the clock's time then, ms. */
  #from = 0
  #since = 0
  readonly #listeners = new Set<() => void>()

  constructor(private readonly clock: () => number = () => performance.now()) {}

  /** What is played; null where there is nothing. */
  get span(): Span | null {
    return this.#spans.tree ?? this.#spans.clip ?? null
  }

  /** Whether a tree is played, alone or with its clip. */
  get hasTree(): boolean {
    return this.#spans.tree !== undefined
  }

  get playing(): boolean {
    return this.#playing && this.span !== null
  }

  /** How fast it plays, 1 as it was filmed. */
  get speed(): number {
    return this.#speed
  }

  /** The place, seconds from the beginning; after the end it begins again. */
  get seconds(): number {
    const { span } = this
    if (!span || !(span.seconds > 0)) return 0
    const passed = this.#playing ? ((this.clock() - this.#since) / 1000) * this.#speed : 0
    return (this.#from + passed) % span.seconds
  }

  /** The clip's frame at the place, from 0; null where nothing was filmed, or where it leads back to the first frame. */
  get frame(): number | null {
    const { span, seconds } = this
    if (!span?.frames || !span.framesPerSecond) return null
    const frame = Math.floor(seconds * span.framesPerSecond + 1e-6)
    return frame < span.frames ? frame : null
  }

  /** Set what one of the players plays; null for nothing. The place stays where it can. */
  setSpan(player: Player, span: Span | null): void {
    const { [player]: before, ...others } = this.#spans
    if (isSame(before, span)) return
    this.#move(this.seconds, () => {
      this.#spans = span ? { ...others, [player]: span } : others
    })
  }

  play(): void {
    if (!this.playing) this.#move(this.seconds, () => (this.#playing = true))
  }

  pause(): void {
    if (this.#playing) this.#move(this.seconds, () => (this.#playing = false))
  }

  setSpeed(speed: number): void {
    this.#move(this.seconds, () => (this.#speed = speed))
  }

  /** Go to a place, seconds from the beginning. */
  seek(seconds: number): void {
    this.#move(Math.max(seconds, 0))
  }

  /** Pause at a frame of the clip, from 0: in its middle, where the video shows it for sure. */
  showFrame(frame: number): void {
    const { frames, framesPerSecond } = this.span ?? {}
    if (!frames || !framesPerSecond) return
    const shown = Math.min(Math.max(frame, 0), frames - 1)
    this.#move((shown + 0.5) / framesPerSecond, () => (this.#playing = false))
  }

  /** Call a listener when it plays or pauses, or the place, speed or span is set; returns a function that ends this. */
  watch(listener: () => void): () => void {
    this.#listeners.add(listener)
    return () => this.#listeners.delete(listener)
  }

  /** Set the place, make a change, and tell it. */
  #move(seconds: number, change: () => void = () => {}): void {
    change()
    this.#from = seconds
    this.#since = this.clock()
    for (const listener of this.#listeners) listener()
  }
}

function isSame(one: Span | undefined, other: Span | null): boolean {
  const isEqual = (key: keyof Span) => one?.[key] === other?.[key]
  return Boolean(one) === Boolean(other) && isEqual('seconds') && isEqual('frames') && isEqual('framesPerSecond')
}
