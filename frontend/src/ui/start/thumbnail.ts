const WIDTH = 480
const HEIGHT = 360
const WHITE = 255

/** Draw the last view of a model's preview picture into a card's canvas, with its sky and ground continued to both sides. */
export async function drawThumbnail(canvas: HTMLCanvasElement, url: string): Promise<void> {
  const preview = new Image()
  preview.src = url
  await preview.decode()
  canvas.width = WIDTH
  canvas.height = HEIGHT
  const pen = canvas.getContext('2d', { willReadFrequently: true })
  if (!pen) return
  const { naturalWidth, naturalHeight } = preview
  const from = afterGap(topRow(pen, preview)) + 1 // the gap's white shines through the first column
  const width = ((naturalWidth - from) * HEIGHT) / naturalHeight
  const left = (WIDTH - width) / 2
  pen.imageSmoothingEnabled = false
  pen.drawImage(preview, from, 0, 1, naturalHeight, 0, 0, Math.max(0, left) + 1, HEIGHT)
  pen.drawImage(preview, naturalWidth - 1, 0, 1, naturalHeight, WIDTH / 2, 0, WIDTH / 2, HEIGHT)
  pen.imageSmoothingEnabled = true
  pen.drawImage(preview, from, 0, naturalWidth - from, naturalHeight, left, 0, width, HEIGHT)
}

/** Return the column behind the last white gap between views, in the top row of a picture (RGBA); 0 where there is no gap. */
export function afterGap(row: Uint8ClampedArray): number {
  for (let column = row.length / 4 - 1; column >= 0; column--) {
    const pixel = row.subarray(column * 4, column * 4 + 3)
    if (pixel.every(shade => shade === WHITE)) return column + 1
  }
  return 0
}

function topRow(pen: CanvasRenderingContext2D, preview: HTMLImageElement): Uint8ClampedArray {
  const { naturalWidth } = preview
  pen.canvas.width = naturalWidth
  pen.drawImage(preview, 0, 0, naturalWidth, 1, 0, 0, naturalWidth, 1)
  const row = pen.getImageData(0, 0, naturalWidth, 1).data
  pen.canvas.width = WIDTH
  return row
}
