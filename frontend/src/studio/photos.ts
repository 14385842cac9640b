import type { Client } from '../api/client'
import type { Limits } from '../api/types'
import type { PhotoSheet } from '../state'
import { text } from '../text'
import { PageFault, sentenceOf } from './faultText'
import { isVideo } from './videos'

/** Media types of the photos that the service reads, by file ending; each type's usual ending comes first. */
export const TYPES: Readonly<Record<string, string>> = {
  jpg: 'image/jpeg',
  jpeg: 'image/jpeg',
  png: 'image/png',
  webp: 'image/webp',
  heic: 'image/heic',
  heif: 'image/heif',
  hif: 'image/heif',
  avif: 'image/avif',
  tif: 'image/tiff',
  tiff: 'image/tiff',
}

/** Return whether a file is a picture; whether it is a photo that can be read the service decides. A GIF is a video. */
export function isPicture(file: File): boolean {
  return typeOf(file).startsWith('image/') && !isVideo(file)
}

/** Return a file's media type, by its ending where the browser knows none (HEIC, in most). */
export function typeOf(file: File): string {
  return file.type || TYPES[file.name.slice(file.name.lastIndexOf('.') + 1).toLowerCase()] || ''
}

/** Send a photo to the service, and return its sheet. */
export async function upload(chosen: Blob, client: Client, limits: Limits | null): Promise<PhotoSheet> {
  const file = typed(chosen)
  const { id, width, height, image, warnings } = await send(file, client, limits)
  const corrections = warnings?.map(({ detail }) => sentenceOf(detail)).join(' ')
  const url = await pictureOf(file, { width, height }, image)
  return { id, width, height, file, url, ...(corrections && { corrections }) }
}

/** Return a photo that the browser cannot show, as a picture converted by the service, which does not keep the photo. */
export async function convertPicture(file: Blob, client: Client, limits: Limits | null): Promise<Blob> {
  const { id, image } = await send(file, client, limits)
  const picture = await client.getFile(image)
  await client.deletePhoto(id)
  return picture
}

/** Return an address of the upright picture: the file's own if the browser decodes it to the service's size. */
export async function pictureOf(file: Blob, size: { width: number; height: number }, stored: string): Promise<string> {
  if (file.type !== 'image/jpeg') return stored
  const picture = await createImageBitmap(file).catch(() => null)
  const isSameSize = picture?.width === size.width && picture.height === size.height
  picture?.close()
  return isSameSize ? URL.createObjectURL(file) : stored
}

async function send(file: Blob, client: Client, limits: Limits | null) {
  const most = limits?.photo_bytes ?? Number.POSITIVE_INFINITY
  if (file.size > most) throw new PageFault(text.faults.fileTooLarge(file.size, most))
  return client.addPhoto(file)
}

/** Return a file without a media type with the one that its name tells. */
function typed(file: Blob): Blob {
  return file.type === '' && file instanceof File ? new File([file], file.name, { type: typeOf(file) }) : file
}
