/** Milliseconds that growth may take for each of its seconds, where frames are slow or do not come. */
const PATIENCE = 5000

/** Lets a tree grow over some seconds of frames. */
export class Ageing {
  private run: { seconds: number; spent: number; done: () => void; overdue: ReturnType<typeof setTimeout> } | null =
    null

  /** `show` is given the share of the growth, 0..1, each time it has moved on. */
  constructor(private readonly show: (share: number) => void) {}

  get running(): boolean {
    return this.run !== null
  }

  /** Begin; the promise ends with the growth, however that comes about. */
  start(seconds: number): Promise<void> {
    this.stop()
    return new Promise(done => {
      this.run = { seconds, spent: 0, done, overdue: setTimeout(() => this.stop(), seconds * PATIENCE) }
      this.show(0)
    })
  }

  /** Let time pass; says whether it grows still. */
  step(seconds: number): boolean {
    if (!this.run) return false
    this.run.spent += seconds
    if (this.run.spent >= this.run.seconds) this.stop()
    else this.show(this.run.spent / this.run.seconds)
    return this.running
  }

  /** End it, fully grown. */
  stop(): void {
    const { run } = this
    if (!run) return
    this.run = null
    clearTimeout(run.overdue)
    this.show(1)
    run.done()
  }
}
