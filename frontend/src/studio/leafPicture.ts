import { text } from '../text'
import { Unusable } from './faultText'
import { isPng } from './png'

/** A picture is looked at in this size, px: what is transparent anywhere is so there, too. */
const SIDE = 128

/** Take a picture as a leaf, or throw `Unusable` where it is none: a PNG of which some is transparent, and not all. */
export async function readLeaf(
  file: Blob,
  mostBytes: number,
  alphaOf: (file: Blob) => Promise<Uint8Array> = decodedAlpha,
): Promise<Blob> {
  if (!(await isPng(file))) throw new Unusable(text.faults.ownPicture.notPng)
  if (file.size > mostBytes) throw new Unusable(text.faults.fileTooLarge(file.size, mostBytes))
  const alpha = await alphaOf(file).catch(() => {
    throw new Unusable(text.faults.ownPicture.unreadable)
  })
  if (alpha.every(opacity => opacity === 255)) throw new Unusable(text.faults.ownPicture.opaque)
  if (alpha.every(opacity => opacity === 0)) throw new Unusable(text.faults.ownPicture.empty)
  return file.slice(0, file.size, 'image/png')
}

/** How opaque a picture's pixels are, 0 to 255. */
async function decodedAlpha(file: Blob): Promise<Uint8Array> {
  const picture = await createImageBitmap(file)
  const pen = new OffscreenCanvas(SIDE, SIDE).getContext('2d')!
  pen.imageSmoothingQuality = 'high'
  pen.drawImage(picture, 0, 0, SIDE, SIDE)
  picture.close()
  return Uint8Array.from({ length: SIDE * SIDE }, alphaIn(pen.getImageData(0, 0, SIDE, SIDE).data))
}

function alphaIn(rgba: Uint8ClampedArray): (_: unknown, pixel: number) => number {
  return (_, pixel) => rgba[pixel * 4 + 3]!
}
