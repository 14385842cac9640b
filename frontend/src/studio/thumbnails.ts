import type { Client } from '../api/client'
import type { CapturePhoto } from '../api/types'
import type { DraftStore } from './draftStore'

/** The longer side of a thumbnail, px. */
const SIDE = 192
const QUALITY = 0.8

/** What has a picture on the service. */
type Pictured = Pick<CapturePhoto, 'id' | 'name' | 'image'>

/** Small pictures of the photos of many: each is made once, and kept with the drawing. */
export class Thumbnails {
  /** Addresses by the photos' ids. */
  readonly #urls = new Map<string, Promise<string | null>>()
  /** One is made at a time: a photo is large. */
  #last: Promise<unknown> = Promise.resolve()

  constructor(
    private readonly client: Client,
    private readonly drafts: Pick<DraftStore, 'thumbnail' | 'keepThumbnail'>,
    private readonly shrink: (picture: Blob) => Promise<Blob> = shrunk,
  ) {}

  /** Return the address of a photo's thumbnail; it is made of `file` where that is at hand. Null where it cannot be made. */
  of(photo: Pictured, file: Blob | null = null): Promise<string | null> {
    const known = this.#urls.get(photo.id)
    if (known) return known
    const made = this.#last.then(() => this.#make(photo, file)).catch(() => null)
    this.#last = made
    this.#urls.set(photo.id, made)
    return made
  }

  async #make({ id, image }: Pictured, file: Blob | null): Promise<string> {
    const kept = await this.drafts.thumbnail(id)
    const thumbnail = kept ?? (await this.#from(file, image))
    if (!kept) await this.drafts.keepThumbnail(id, thumbnail)
    return URL.createObjectURL(thumbnail)
  }

  /** Return a thumbnail of the file; without one, or where the browser cannot read it, of the service's picture. */
  async #from(file: Blob | null, image: string): Promise<Blob> {
    const own = file && (await this.shrink(file).catch(() => null))
    return own ?? this.shrink(await this.client.getFile(image))
  }
}

async function shrunk(file: Blob): Promise<Blob> {
  const picture = await createImageBitmap(file)
  const factor = Math.min(1, SIDE / Math.max(picture.width, picture.height))
  const canvas = new OffscreenCanvas(Math.round(picture.width * factor), Math.round(picture.height * factor))
  const ctx = canvas.getContext('2d')!
  ctx.imageSmoothingQuality = 'high'
  ctx.drawImage(picture, 0, 0, canvas.width, canvas.height)
  picture.close()
  return canvas.convertToBlob({ type: 'image/jpeg', quality: QUALITY })
}
