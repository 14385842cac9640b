import { useState } from 'preact/hooks'
import type { Line, Point } from '../../strokes'
import { text } from '../../text'

const { siblings: words } = text
/** The pad's size, px of the outline. */
const [WIDTH, HEIGHT] = [240, 240]
const GROUND = 226
/** How far apart points of a line are at least, px. */
const STEP = 3
/** The smallest outline, as a share of the pad's width and height. */
const LEAST = 0.2

interface Props {
  readonly outline: Line | null
  /** Absent where the outline is only shown. */
  draw?(outline: Line | null): void
}

/** A pad on which an outline is drawn in one line, which closes by itself; or an outline that is shown whole. */
export function OutlinePad({ outline, draw }: Props) {
  const [line, setLine] = useState<readonly Point[]>([])
  const [isSmall, setSmall] = useState(false)
  const isDrawing = line.length > 0
  const begin = (event: PointerEvent) => {
    ;(event.currentTarget as Element).setPointerCapture(event.pointerId)
    setLine([placeOf(event)])
  }
  const go = (event: PointerEvent) => {
    const place = placeOf(event)
    if (isDrawing && distance(line.at(-1)!, place) >= STEP) setLine([...line, place])
  }
  const end = () => {
    const isEnough = isLarge(line)
    setSmall(!isEnough)
    draw?.(isEnough ? line : null)
    setLine([])
  }
  const shown = isDrawing ? line : (outline ?? [])
  return (
    <div class="outline-pad">
      <svg
        viewBox={draw ? `0 0 ${WIDTH} ${HEIGHT}` : boxOf(shown)}
        role="img"
        aria-label={words.pad}
        {...(draw && { onPointerDown: begin, onPointerMove: go, onPointerUp: end, onPointerCancel: () => setLine([]) })}
      >
        {draw && <path class="outline-ground" d={`M0 ${GROUND}H${WIDTH}`} />}
        <path class="outline-line" d={pathOf(shown, !isDrawing)} />
      </svg>
      {draw && <p class={isSmall ? 'fault' : 'soft'}>{isSmall ? words.padTooSmall : words.padHint}</p>}
    </div>
  )
}

function placeOf(event: PointerEvent): Point {
  const { left, top, width, height } = (event.currentTarget as Element).getBoundingClientRect()
  const round = (number: number) => Math.round(number * 10) / 10
  return [round(((event.clientX - left) / width) * WIDTH), round(((event.clientY - top) / height) * HEIGHT)]
}

function distance([x, y]: Point, [across, down]: Point): number {
  return Math.hypot(x - across, y - down)
}

function isLarge(line: Line): boolean {
  const [x, y] = [line.map(([across]) => across), line.map(([, down]) => down)]
  return spread(x) > LEAST * WIDTH && spread(y) > LEAST * HEIGHT
}

function spread(numbers: readonly number[]): number {
  return Math.max(...numbers) - Math.min(...numbers)
}

function boxOf(line: Line): string {
  const [x, y] = [line.map(([across]) => across), line.map(([, down]) => down)]
  return `${Math.min(...x) - 2} ${Math.min(...y) - 2} ${spread(x) + 4} ${spread(y) + 4}`
}

function pathOf(line: Line, isClosed: boolean): string {
  return line.length ? `M${line.map(point => point.join(' ')).join('L')}${isClosed ? 'Z' : ''}` : ''
}
