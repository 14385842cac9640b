import type { Client } from '../api/client'
import type { Limits, Photo } from '../state'
import { text } from '../text'
import { Unusable } from './sentences'

/** Send a photo to the service. */
export async function uploaded(file: Blob, client: Client, limits: Limits | null): Promise<Photo> {
  const most = limits?.photo_bytes ?? Number.POSITIVE_INFINITY
  if (file.size > most) throw new Unusable(text.faults.photoTooLarge(file.size / 1e6, most / 1e6))
  const { id, width, height, image } = await client.addPhoto(file)
  return { id, width, height, file, url: await pictureOf(file, { width, height }, image) }
}

/** Give an address that shows the upright picture: the file itself where the browser sees it as the service does. */
export async function pictureOf(file: Blob, size: { width: number; height: number }, stored: string): Promise<string> {
  if (file.type !== 'image/jpeg') return stored
  const picture = await createImageBitmap(file).catch(() => null)
  const alike = picture?.width === size.width && picture.height === size.height
  picture?.close()
  return alike ? URL.createObjectURL(file) : stored
}
