import type { Accounts } from '../api/accounts'
import { Refused, setGate, Unreachable } from '../api/request'
import type { Session } from '../api/types'
import type { Fault, Store } from '../state'
import { text } from '../text'
import { duration } from '../text/numbers'
import { faultOf } from './faultText'

const RETRY_MS = 2000
/** The longest wait before a request is sent again by itself, and the least that is told, s. */
const [LONGEST_WAIT_S, TOLD_WAIT_S] = [60, 3]

/** Signs in to a hosted service and out of it; requests that lack it wait until somebody is signed in. */
export class SessionActions {
  /** The member that was signed in last. */
  #last: string | null = null
  /** How many requests wait since there were too many, and what removes the notice about them. */
  #waiting = 0
  #dismiss = () => {}

  constructor(
    private readonly store: Store,
    private readonly accounts: Accounts,
    /** Begins the page anew, with nothing open. */
    private readonly beginAnew: () => void,
    private readonly wait = (ms: number) => new Promise<void>(done => setTimeout(done, ms)),
  ) {
    setGate(refused => this.#lacking(refused))
  }

  /** Find out who is signed in; it is asked to sign in where that is needed and nobody is. */
  async find(): Promise<void> {
    try {
      this.#take(await this.accounts.getSession())
    } catch (error) {
      if (error instanceof Refused) return this.#askFor(error)
      if (!(error instanceof Unreachable)) throw error
      await this.wait(RETRY_MS)
      await this.find()
    }
  }

  /** Sign in with a key; returns what is wrong with it. */
  async signIn(key: string): Promise<Fault | null> {
    try {
      this.#take(await this.accounts.signIn(key.trim()))
      return null
    } catch (error) {
      return faultOf(error)
    }
  }

  /** Sign out; what is drawn stays in this browser. */
  async signOut(): Promise<void> {
    try {
      await this.accounts.signOut()
    } catch (error) {
      if (error instanceof Unreachable) return void this.store.notify({ text: text.access.stillSignedIn })
      if (!(error instanceof Refused)) throw error // refused: the session had ended before
    }
    this.store.set({ session: null, signIn: 'first', dialog: null })
  }

  /** Take over who is signed in; whoever is another than before begins with nothing open, unless that would lose strokes. */
  #take(session: Session): void {
    const { id } = session.member
    const isOther = this.#last !== null && this.#last !== id
    this.#last = id
    if (isOther && this.store.state.kept) this.beginAnew()
    else this.store.set({ session: session.hosted ? session : null, signIn: null })
  }

  /** Show the sign-in, where a refusal says that nobody is signed in. */
  #askFor({ code }: Refused): void {
    const { session, signIn } = this.store.state
    if (code === 'unauthenticated') this.store.set({ signIn: signIn ?? (session ? 'again' : 'first') })
  }

  /** Wait for what a request lacked; resolves to whether it is to be sent again. */
  async #lacking({ code, retryAfter }: Refused): Promise<boolean> {
    if (code === 'unauthenticated') await this.#untilSignedIn()
    else if (code === 'rate_limited' && (retryAfter ?? 1) <= LONGEST_WAIT_S) await this.#untilFewer(retryAfter ?? 1)
    else return false
    return true
  }

  /** Resolve when somebody is signed in, who may be so already: in another tab, or since the request was sent. */
  async #untilSignedIn(): Promise<void> {
    if (!this.store.state.signIn) {
      await this.find()
      if (!this.store.state.signIn) return this.wait(RETRY_MS)
    }
    await new Promise<void>(done => {
      const end = this.store.watch(
        ({ signIn }) => signIn === null,
        isIn => {
          if (!isIn) return
          end()
          done()
        },
      )
    })
  }

  /** Wait as long as the service says, and tell it where that is long. */
  async #untilFewer(seconds: number): Promise<void> {
    if (seconds >= TOLD_WAIT_S && !this.#waiting++)
      this.#dismiss = this.store.notify({ text: text.access.waiting(duration(seconds)), stays: true })
    await this.wait(seconds * 1000)
    if (seconds >= TOLD_WAIT_S && !--this.#waiting) this.#dismiss()
  }
}
