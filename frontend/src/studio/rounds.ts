/** Runs a task one at a time: all requests during a run lead to one more run. */
export class Rounds {
  #running = false
  #requested = false

  constructor(private readonly task: () => Promise<void>) {}

  /** Run the task, now or after the present run; an error ends the runs until the next request. */
  async ask(): Promise<void> {
    this.#requested = true
    if (this.#running) return
    this.#running = true
    try {
      while (this.#requested) {
        this.#requested = false
        await this.task()
      }
    } finally {
      this.#running = false
    }
  }
}
