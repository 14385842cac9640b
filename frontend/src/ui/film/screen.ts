import type { Tracks } from '../../api/types'
import type { Film } from './film'
import { pathsAt, type TrackPath } from './trackPaths'

/** The most pixels of a screen along its longer side. */
const LONGEST = 1280
/** The colours of the points, so that neighbours can be told apart. */
const COLOURS = ['#ffd166', '#7ae582', '#9bd1ff', '#ff9fb2']

/** Keep a canvas at a film's frame; returns a function that ends this. */
export function showFilm(canvas: HTMLCanvasElement, film: Film): () => void {
  const draw = () => drawStill(canvas, film)
  draw()
  return film.watch(draw)
}

function drawStill(canvas: HTMLCanvasElement, film: Film): void {
  const { still } = film
  if (!still) return
  const factor = Math.min(1, LONGEST / Math.max(still.width, still.height))
  const [width, height] = [Math.round(still.width * factor), Math.round(still.height * factor)]
  if (canvas.width !== width || canvas.height !== height) Object.assign(canvas, { width, height })
  canvas.getContext('2d')!.drawImage(still.image, 0, 0, width, height)
}

/** Draw the tracks of a frame (from 0; null for none) on a canvas as wide as it is shown; `width` is the clip's, px. */
export function drawTracks(canvas: HTMLCanvasElement, tracks: Tracks, frame: number | null, width: number): void {
  const ctx = canvas.getContext('2d')!
  ctx.clearRect(0, 0, canvas.width, canvas.height)
  if (frame === null) return
  const scale = canvas.width / width
  ctx.lineCap = 'round'
  for (const path of pathsAt(tracks, frame)) drawPath(ctx, path, scale)
}

function drawPath(ctx: CanvasRenderingContext2D, { track, way }: TrackPath, scale: number): void {
  const colour = COLOURS[track % COLOURS.length]!
  const [x, y] = way.at(-1)!
  for (const [style, wide] of [
    ['rgb(0 0 0 / 40%)', 3],
    [colour, 1.5],
  ] as const) {
    ctx.strokeStyle = style
    ctx.lineWidth = wide * devicePixelRatio
    ctx.beginPath()
    for (const [left, top] of way) ctx.lineTo(left * scale, top * scale)
    ctx.stroke()
    ctx.fillStyle = style
    ctx.beginPath()
    ctx.arc(x * scale, y * scale, wide * 1.1 * devicePixelRatio, 0, 2 * Math.PI)
    ctx.fill()
  }
}
