import type { Client } from '../api/client'
import { followCapture, isSolving } from '../api/follow'
import { Refused, Unreachable } from '../api/request'
import type { CaptureInfo, CapturePhoto, CaptureState } from '../api/types'
import { captureOf, captureSheet } from '../sheets'
import type { Capture, Sheets, Store } from '../state'
import { text } from '../text'
import { faultOf, sentenceOf } from './faultText'
import { pictureOf } from './photos'
import type { Thumbnails } from './thumbnails'

const RETRY_MS = 1500
const PNG = { type: 'image/png' }

type CaptureSheets = Sheets & { readonly source: 'capture' }

/** A capture with its first photo, and the files that it lacks. */
interface Begun {
  readonly sheets: CaptureSheets
  readonly rest: readonly File[]
}

/** Sends many photos of one tree to the service, and has it find where they were taken. */
export class Captures {
  #stopFollowing = () => {}
  /** Files that were chosen and have not been sent. */
  #waiting: File[] = []
  /** Files that were sent, by their photo's id: the browser shows them sooner than the service's pictures. */
  readonly #files = new Map<string, File>()

  constructor(
    private readonly store: Store,
    private readonly client: Client,
    private readonly thumbnails: Pick<Thumbnails, 'of'>,
    private readonly wait = (ms: number) => new Promise<void>(done => setTimeout(done, ms)),
  ) {}

  /**
   * Make a capture, send the first of the files that the service can read, and return its sheets and the files for `send`.
   *
   * Throws what the service refused where it can read none.
   */
  async begin(name: string, files: readonly File[]): Promise<Begun> {
    const { id } = await this.client.makeCapture(name)
    const sorted = byName(files)
    let refused: Refused | null = null
    for (const [index, file] of sorted.entries()) {
      try {
        const photo = await this.client.addCapturePhoto(id, file, file.name)
        this.#files.set(photo.id, file)
        const capture = { id, photos: [photo], cameras: [], cloud: null, chosen: files.length - index }
        return { sheets: sheetsOf(capture, photo), rest: sorted.slice(index + 1) }
      } catch (error) {
        if (!(error instanceof Refused)) throw error
        refused = error
      }
    }
    throw refused ?? new TypeError('there must be a photo')
  }

  /** Return the sheets of a capture as the service has it, with a photo drawn on. */
  opened(info: CaptureInfo, drawnOn: string | null, chosen = info.photos.length): CaptureSheets | null {
    const front = info.photos.find(({ name }) => name === drawnOn) ?? info.photos[0]
    const { id, photos, cameras, cloud } = info
    return front ? sheetsOf({ id, photos, cameras, cloud, chosen: Math.max(chosen, photos.length) }, front) : null
  }

  /** Go on with a capture that was opened: show how far it is, and follow what is under way. */
  goOn(solve: CaptureState): void {
    this.store.set({ solve })
    this.#showPicture()
    if (isSolving(solve)) this.#follow(solve.id)
  }

  /** Send files to the open capture, and then have the cameras found. */
  async send(files: readonly File[]): Promise<void> {
    this.#waiting.push(...byName(files))
    if (this.store.state.sending) return
    this.#showPicture()
    this.store.set({ sending: true })
    this.store.fault('capture', null)
    const done = await this.#sendAll().finally(() => this.store.set({ sending: false }))
    if (done) await this.solve()
  }

  /** Add photos to the open capture; those that it has already are not doubled. Where the service lost it, a new one is made. */
  async add(files: readonly File[]): Promise<void> {
    const capture = this.#capture
    if (!capture) return
    const known = new Set(capture.photos.map(({ name }) => name))
    const fresh = files.filter(({ name }) => !known.has(name)).length
    if (capture.id === null) await this.#beginAgain(files.length)
    else this.#change({ chosen: Math.max(capture.chosen, capture.photos.length + fresh) })
    await this.send(files)
  }

  /** Do without the photos that were chosen and are not at hand. */
  async leaveOut(): Promise<void> {
    const capture = this.#capture
    if (!capture) return
    this.#change({ chosen: capture.photos.length })
    await this.solve()
  }

  /** Draw on another photo, by its name. */
  choose(name: string): void {
    const { sheets } = this.store.state
    const photo = captureOf({ sheets })?.photos.find(other => other.name === name)
    if (!photo || sheets?.source !== 'capture' || sheets.front.id === photo.id) return
    const { selection } = this.store.state
    // A joint keeps its number over every photo; a stroke belongs to one.
    const kept = selection?.kind === 'traced' ? selection : null
    this.store.set({ sheets: { ...sheets, front: captureSheet(photo) }, selection: kept })
    this.#showPicture()
  }

  /** Have the cameras found, where there are enough photos. */
  async solve(): Promise<void> {
    const capture = this.#capture
    const least = this.store.state.limits?.capture_photos_min ?? 0
    if (!capture?.id || capture.photos.length < least) return
    this.store.fault('capture', null)
    const info = await this.#asking(capture.id, id => this.client.solveCapture(id))
    if (info) await this.#update(info)
    if (info && isSolving(info)) this.#follow(info.id)
  }

  /** Stop looking for the cameras. */
  async cancel(): Promise<void> {
    const id = this.#capture?.id
    const info = id && (await this.#asking(id, known => this.client.cancelSolve(known)))
    if (info) this.store.set({ solve: stateOf(info) })
  }

  /** Return all photos that the service has, as they were chosen or else as it keeps them. */
  async files(): Promise<File[]> {
    const photos = this.#capture?.photos ?? []
    const stored = async ({ name, image }: CapturePhoto) => new File([await this.client.getFile(image)], name, PNG)
    return Promise.all(photos.map(photo => this.#files.get(photo.id) ?? stored(photo)))
  }

  /** Stop following and sending: something else is opened. */
  stop(): void {
    this.#stopFollowing()
    this.#stopFollowing = () => {}
    this.#waiting = []
  }

  get #capture(): Capture | null {
    return captureOf(this.store.state)
  }

  /** Send all that waits; false where something else was opened meanwhile, or the service lost the capture. */
  async #sendAll(): Promise<boolean> {
    const id = this.#capture?.id
    while (id && this.#capture?.id === id && this.#waiting.length) {
      await this.#sendOne(id, this.#waiting[0]!)
    }
    return Boolean(id) && this.#capture?.id === id
  }

  async #sendOne(id: string, file: File): Promise<void> {
    try {
      const photo = await this.client.addCapturePhoto(id, file, file.name)
      this.store.set({ online: true })
      if (this.#capture?.id !== id) return
      this.#files.set(photo.id, file)
      void this.thumbnails.of(photo, file)
      this.#change({ photos: withPhoto(this.#capture.photos, photo) })
      this.#waiting = this.#waiting.slice(1)
    } catch (error) {
      await this.#recover(error, id, file)
    }
  }

  /** Wait where the service cannot be reached; say which photo it cannot read, and go on with the others. */
  async #recover(error: unknown, id: string, file: File): Promise<void> {
    if (error instanceof Unreachable) {
      this.store.set({ online: false })
      return this.wait(RETRY_MS)
    }
    if (!(error instanceof Refused)) throw error
    if (this.#capture?.id !== id) return
    if (error.status === 404) return this.#lose()
    this.#waiting = this.#waiting.slice(1)
    this.#change({ chosen: this.#capture.chosen - 1 })
    this.store.notify({ text: text.capture.refused(file.name, sentenceOf(error.message)), stays: true })
  }

  /** Make a capture in place of one that the service lost. */
  async #beginAgain(chosen: number): Promise<void> {
    try {
      const { id } = await this.client.makeCapture(this.store.state.name)
      this.#change({ id, photos: [], cameras: [], cloud: null, chosen })
      this.store.set({ traced: null, liveTree: null })
    } catch (error) {
      this.store.fault('capture', faultOf(error))
    }
  }

  #follow(id: string): void {
    this.#stopFollowing()
    this.#stopFollowing = followCapture(id, {
      changed: solve => void this.#update(solve),
      connected: online => this.store.set({ online }),
      gone: () => void this.#followAgain(id),
    })
  }

  /** After the events have ended: follow them again, unless the capture is gone or there is nothing more to come. */
  async #followAgain(id: string): Promise<void> {
    await this.wait(RETRY_MS)
    const info = await this.#asking(id, known => this.client.getCapture(known))
    if (info) await this.#update(info)
    if (info && isSolving(info)) this.#follow(id)
  }

  /** Show how far the search is; once it has ended well, take over what was found. */
  async #update(now: CaptureState | CaptureInfo): Promise<void> {
    if (this.#capture?.id !== now.id) return
    const lacksCameras = now.status === 'solved' && !isWhole(now)
    const info = lacksCameras ? await this.#asking(now.id, id => this.client.getCapture(id)) : now
    if (!info || this.#capture?.id !== now.id) return
    if (isWhole(info)) this.#take(info)
    this.store.set({ solve: stateOf(info), online: true })
  }

  /** Take over what was found; what was traced by other cameras no longer holds. */
  #take({ photos, cameras, cloud }: CaptureInfo): void {
    this.#change({ photos, cameras, cloud })
    this.store.set({ traced: null, liveTree: null })
  }

  /** Return what a call returns, repeated while the service cannot be reached; null where it fails, which is shown. */
  async #asking(id: string, call: (id: string) => Promise<CaptureInfo>): Promise<CaptureInfo | null> {
    while (this.#capture?.id === id) {
      try {
        return await call(id)
      } catch (error) {
        if (error instanceof Refused && error.status === 404) this.#lose()
        else if (!(error instanceof Unreachable)) this.store.fault('capture', faultOf(error))
        if (!(error instanceof Unreachable)) return null
        this.store.set({ online: false })
        await this.wait(RETRY_MS)
      }
    }
    return null
  }

  /** The service no longer has the capture: its photos are asked for. */
  #lose(): void {
    this.#waiting = []
    this.#stopFollowing()
    this.#change({ id: null })
    this.store.set({ solve: null })
  }

  #change(change: Partial<Capture>): void {
    const { sheets } = this.store.state
    if (sheets?.source !== 'capture') return
    const capture = { ...sheets.capture, ...change }
    const front = capture.photos.find(({ name }) => name === sheets.front.name)
    const same = !front || front.id === sheets.front.id
    this.store.set({ sheets: { ...sheets, capture, front: same ? sheets.front : captureSheet(front) } })
    if (!same) this.#showPicture()
  }

  /** Show the photo that is drawn on: at first its thumbnail, then its picture. */
  #showPicture(): void {
    const { sheets } = this.store.state
    const photo = sheets?.source === 'capture' && sheets.capture.photos.find(({ id }) => id === sheets.front.id)
    if (!photo) return
    const file = this.#files.get(photo.id) ?? null
    const show = (url: string | null) => {
      const { sheets: now } = this.store.state
      if (url && now?.source === 'capture' && now.front.id === photo.id && now.front.url !== url)
        this.store.set({ sheets: { ...now, front: { ...now.front, url } } })
    }
    void this.thumbnails.of(photo, file)
    if (file) void pictureOf(file, photo, photo.image).then(show)
  }
}

function sheetsOf(capture: Capture, front: CapturePhoto): CaptureSheets {
  return { source: 'capture', front: captureSheet(front), side: null, capture }
}

/** Return the photos with one more, by name. */
function withPhoto(photos: readonly CapturePhoto[], photo: CapturePhoto): CapturePhoto[] {
  return [...photos.filter(({ id }) => id !== photo.id), photo].sort((one, other) => compare(one.name, other.name))
}

function byName(files: readonly File[]): File[] {
  return [...files].sort((one, other) => compare(one.name, other.name))
}

/** As the service orders names: 10 comes before 2. */
function compare(one: string, other: string): number {
  return one < other ? -1 : Number(one > other)
}

function isWhole(state: CaptureState | CaptureInfo): state is CaptureInfo {
  return 'photos' in state
}

/** Return how far a capture is, without its photos and what was found of them. */
function stateOf({ photos: _, cameras: __, cloud: ___, ...state }: CaptureState & Partial<CaptureInfo>): CaptureState {
  return state
}
