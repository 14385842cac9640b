import { frameUrl, videoUrl } from '../api/addresses'
import type { Client } from '../api/client'
import { Unreachable } from '../api/request'
import type { ClipInfo, UploadInfo } from '../api/types'
import { clipOf, frameSheet } from '../sheets'
import type { Clip, Sheets, Store } from '../state'
import { withFrame } from '../strokes'
import { text } from '../text'
import { faultOf, PageFault } from './faultText'
import type { Thumbnails } from './thumbnails'

const RETRY_MS = 1500
/** Bytes of a part: small enough that little is lost with the connection. */
const PART = 4 * 1024 * 1024

type ClipSheets = Sheets & { readonly source: 'clip' }

/** Sends videos to the service, in parts, and keeps the sheet at the frame that is drawn over. */
export class Clips {
  /** The files that were sent, by their clip's id: the browser plays them without asking the service. */
  readonly #files = new Map<string, File>()
  /** Counts what was sent, so that one that was given up ends. */
  #sends = 0

  constructor(
    private readonly store: Store,
    private readonly client: Client,
    private readonly thumbnails: Pick<Thumbnails, 'of'>,
    private readonly wait = (ms: number) => new Promise<void>(done => setTimeout(done, ms)),
  ) {
    store.watch(
      state => state.history.present.frame,
      () => this.#showFrame(),
    )
  }

  /** Send a video; it goes on after a lost connection. Throws what the service refuses, and a `PageFault` where it was given up. */
  async send(file: File): Promise<ClipInfo> {
    const most = this.store.state.limits?.clip_bytes ?? Number.POSITIVE_INFINITY
    if (file.size > most) throw new PageFault(text.clip.tooLarge(file.size, most))
    const send = ++this.#sends
    this.store.set({ sent: 0 })
    try {
      const { id } = await this.#trying(send, () => this.client.beginClip(file.name))
      const info = await this.#sendParts(send, id, file)
      this.#files.set(info.id, file)
      return info
    } finally {
      if (send === this.#sends) this.store.set({ sent: null })
    }
  }

  /** Give up what is being sent. */
  stop(): void {
    this.#sends++
    this.store.set({ sent: null })
  }

  /** Return the sheets of a clip, drawn over at a frame, from 0. */
  opened(clip: Clip, frame: number): ClipSheets {
    return { source: 'clip', front: frameSheet(clip, frame), side: null, clip }
  }

  /** Keep a small picture of the open clip with its draft. */
  keepThumbnail(): void {
    const { sheets } = this.store.state
    if (sheets?.source !== 'clip' || sheets.clip.id === null) return
    const { clip, front } = sheets
    void this.thumbnails.of({ id: clip.id!, name: clip.name, image: frameUrl(clip.id!, front.frame, 240) })
  }

  /** Send the open clip's video again, which the service lost; another one is opened in its place, with the same strokes. */
  async sendAgain(file: File): Promise<void> {
    try {
      const info = await this.send(file)
      const { sheets } = this.store.state
      if (sheets?.source !== 'clip') return
      const frame = Math.min(sheets.front.frame, info.frames - 1)
      const { history } = this.store.state
      const drawn = { ...history, present: withFrame(history.present, frame) }
      this.store.set({ sheets: this.opened(info, frame), history: drawn, traced: null, liveTree: null })
      this.store.fault('clip', null)
    } catch (error) {
      this.store.fault('clip', faultOf(error))
    }
  }

  /** Return the video of a clip where it was chosen here; else null. */
  fileOf(id: string): File | null {
    return this.#files.get(id) ?? null
  }

  /** Return the open clip's video, from the service where it was not chosen here. */
  async file(): Promise<File | null> {
    const clip = clipOf(this.store.state)
    if (!clip?.id) return null
    const known = this.fileOf(clip.id)
    if (known) return known
    const video = await this.client.getFile(videoUrl(clip.id))
    return new File([video], clip.name, { type: video.type })
  }

  async #sendParts(send: number, upload: string, file: File): Promise<ClipInfo> {
    for (let offset = 0; ; ) {
      const from = offset
      const sent = await this.#trying(send, () => this.#sendPart(upload, file, from))
      if (!('offset' in sent)) return sent
      offset = sent.offset
      this.store.set({ sent: offset / file.size })
    }
  }

  /** Send the part that begins at `from` bytes; returns the clip after the last one, else how much the service has now. */
  async #sendPart(upload: string, file: File, from: number): Promise<UploadInfo | ClipInfo> {
    const to = Math.min(from + PART, file.size)
    if (to === file.size) this.store.set({ sent: 1 })
    try {
      return await this.client.sendPart(upload, file.slice(from, to), from, to === file.size)
    } catch (error) {
      if (!(error instanceof Unreachable)) throw error
      this.store.set({ online: false })
      await this.wait(RETRY_MS)
      const now = await this.client.getUpload(upload)
      return now.clip === null ? now : this.client.getClip(now.clip)
    }
  }

  /** Return what a call returns, repeated while the service cannot be reached; throws where it was given up meanwhile. */
  async #trying<T>(send: number, call: () => Promise<T>): Promise<T> {
    for (;;) {
      try {
        const answer = await call()
        this.store.set({ online: true })
        if (send !== this.#sends) throw new PageFault(text.clip.givenUp)
        return answer
      } catch (error) {
        if (!(error instanceof Unreachable) || send !== this.#sends) throw error
        this.store.set({ online: false })
        await this.wait(RETRY_MS)
      }
    }
  }

  /** Show the frame that is drawn over. */
  #showFrame(): void {
    const { sheets, history } = this.store.state
    const frame = history.present.frame ?? 0
    if (sheets?.source !== 'clip' || sheets.front.frame === frame) return
    this.store.set({ sheets: { ...sheets, front: frameSheet(sheets.clip, frame) } })
  }
}
