import { text } from '../text'
import { PageFault } from './faultText'
import { isPng } from './png'

/** Side of the copy in which transparency is looked for, px. */
const SIDE = 128

/** Return a picture as a PNG cut-out; throws `PageFault` unless it is a PNG that is partly transparent. */
export async function readCutOut(
  file: Blob,
  mostBytes: number,
  alphaOf: (file: Blob) => Promise<Uint8Array> = decodedAlpha,
): Promise<Blob> {
  if (!(await isPng(file))) throw new PageFault(text.faults.ownPicture.notPng)
  if (file.size > mostBytes) throw new PageFault(text.faults.fileTooLarge(file.size, mostBytes))
  const alpha = await alphaOf(file).catch(() => {
    throw new PageFault(text.faults.ownPicture.unreadable)
  })
  if (alpha.every(opacity => opacity === 255)) throw new PageFault(text.faults.ownPicture.opaque)
  if (alpha.every(opacity => opacity === 0)) throw new PageFault(text.faults.ownPicture.empty)
  return file.slice(0, file.size, 'image/png')
}

/** Return the opacity of a reduced copy's pixels, 0 to 255. */
async function decodedAlpha(file: Blob): Promise<Uint8Array> {
  const picture = await createImageBitmap(file)
  const ctx = new OffscreenCanvas(SIDE, SIDE).getContext('2d')!
  ctx.imageSmoothingQuality = 'high'
  ctx.drawImage(picture, 0, 0, SIDE, SIDE)
  picture.close()
  return Uint8Array.from({ length: SIDE * SIDE }, alphaIn(ctx.getImageData(0, 0, SIDE, SIDE).data))
}

function alphaIn(rgba: Uint8ClampedArray): (_: unknown, pixel: number) => number {
  return (_, pixel) => rgba[pixel * 4 + 3]!
}
