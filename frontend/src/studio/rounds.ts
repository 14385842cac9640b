/**
 * Does something again for as long as it is asked for meanwhile: one round at a time, and one more for all that was asked
 * while it ran.
 */
export class Rounds {
  #running = false
  #due = false

  constructor(private readonly round: () => Promise<void>) {}

  /** Do a round, now or after the one under way; the one that throws is the last until it is asked again. */
  async ask(): Promise<void> {
    this.#due = true
    if (this.#running) return
    this.#running = true
    try {
      while (this.#due) {
        this.#due = false
        await this.round()
      }
    } finally {
      this.#running = false
    }
  }
}
