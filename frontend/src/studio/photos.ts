import type { Client } from '../api/client'
import type { Limits } from '../api/types'
import type { PhotoSheet } from '../state'
import { text } from '../text'
import { sentenceOf, Unusable } from './faultText'

/** Types of the photos that the service reads, by the endings of their files; the usual ending of each comes first. */
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

/** Tell whether a file may be a photo; the service judges any picture, and names those that it does not read. */
export function isPicture(file: File): boolean {
  return typeOf(file).startsWith('image/')
}

/** Name a file's type; by its ending where the browser knows none, as of HEIC in most. */
export function typeOf(file: File): string {
  return file.type || TYPES[file.name.slice(file.name.lastIndexOf('.') + 1).toLowerCase()] || ''
}

/** Send a photo to the service. */
export async function uploaded(chosen: Blob, client: Client, limits: Limits | null): Promise<PhotoSheet> {
  const file = typed(chosen)
  const { id, width, height, image, warnings } = await sent(file, client, limits)
  const corrections = warnings?.map(({ detail }) => sentenceOf(detail)).join(' ')
  const url = await pictureOf(file, { width, height }, image)
  return { id, width, height, file, url, ...(corrections && { corrections }) }
}

/** Have the service turn a photo that the browser cannot show into one that it can; the service does not keep it. */
export async function drawable(file: Blob, client: Client, limits: Limits | null): Promise<Blob> {
  const { id, image } = await sent(file, client, limits)
  const picture = await client.getFile(image)
  await client.deletePhoto(id)
  return picture
}

/** Give an address that shows the upright picture: the file itself where the browser sees it as the service does. */
export async function pictureOf(file: Blob, size: { width: number; height: number }, stored: string): Promise<string> {
  if (file.type !== 'image/jpeg') return stored
  const picture = await createImageBitmap(file).catch(() => null)
  const alike = picture?.width === size.width && picture.height === size.height
  picture?.close()
  return alike ? URL.createObjectURL(file) : stored
}

async function sent(file: Blob, client: Client, limits: Limits | null) {
  const most = limits?.photo_bytes ?? Number.POSITIVE_INFINITY
  if (file.size > most) throw new Unusable(text.faults.fileTooLarge(file.size, most))
  return client.addPhoto(file)
}

/** Give a photo that came without a type the one that its name tells. */
function typed(file: Blob): Blob {
  return file.type === '' && file instanceof File ? new File([file], file.name, { type: typeOf(file) }) : file
}
