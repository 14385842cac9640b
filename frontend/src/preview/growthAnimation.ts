/** Milliseconds that each second of growth may take before it is ended, where frames are slow or do not come. */
const TIMEOUT_MS_PER_SECOND = 5000

/** Animates growth over some seconds of frames. */
export class GrowthAnimation {
  private run: { seconds: number; spent: number; done: () => void; timeout: ReturnType<typeof setTimeout> } | null =
    null

  /** `show` is called with the share of the growth, 0..1, each time it changes. */
  constructor(private readonly show: (share: number) => void) {}

  get running(): boolean {
    return this.run !== null
  }

  /** Start from nothing; the promise resolves when the growth has ended or was stopped. */
  start(seconds: number): Promise<void> {
    this.stop()
    return new Promise(done => {
      this.run = { seconds, spent: 0, done, timeout: setTimeout(() => this.stop(), seconds * TIMEOUT_MS_PER_SECOND) }
      this.show(0)
    })
  }

  /** Advance by a time, seconds; returns whether the growth goes on. */
  step(seconds: number): boolean {
    if (!this.run) return false
    this.run.spent += seconds
    if (this.run.spent >= this.run.seconds) this.stop()
    else this.show(this.run.spent / this.run.seconds)
    return this.running
  }

  /** End the growth at once, fully grown. */
  stop(): void {
    const { run } = this
    if (!run) return
    this.run = null
    clearTimeout(run.timeout)
    this.show(1)
    run.done()
  }
}
