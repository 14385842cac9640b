import { type Extent, fittedTo } from '../sheets'
import { INK, type Inks, PAPER, PAPER_INK } from '../sketch/ink'
import { type Line, NO_STROKES, type Side, type Strokes } from '../strokes'
import { svg } from './dom'

/** Of a pencil's line, as a share of the sheet's height. */
const PENCIL = 0.0035
/** Between two sides, as a share of their height. */
const GAP = 0.12

/** Draw one sheet's strokes as a picture of the sheet's size, over nothing. */
export function drawnOn({ width, height }: Extent, strokes: Side, inks: Inks = INK): SVGSVGElement {
  const frame = { viewBox: `0 0 ${width} ${height}`, preserveAspectRatio: 'xMidYMid slice', 'aria-hidden': 'true' }
  return svg('svg', frame, ...lines(strokes, PENCIL * height, inks))
}

/** Draw both sides of a tree beside each other, as high as each other, with as much paper as they need. */
export function drawnPair(front: Extent, strokes: Strokes, side: Extent | null): SVGSVGElement {
  const { side: drawn, ...ahead } = strokes
  const left =
    side && drawn ? fittedTo(drawn, side, { ...front, width: (side.width * front.height) / side.height }) : null
  const [one, other] = [boxOf(ahead), left && boxOf(left)]
  const [top, bottom] = [Math.min(one.top, other?.top ?? one.top), Math.max(one.bottom, other?.bottom ?? one.bottom)]
  const height = bottom - top
  const shift = other ? one.right + GAP * height - other.left : 0
  const width = (other ? other.right + shift : one.right) - one.left
  const picture = drawnOn({ width, height }, NO_STROKES)
  const pencil = PENCIL * Math.max(height, width) * 2
  picture.setAttribute('viewBox', [one.left, top, width, height].join(' '))
  picture.setAttribute('preserveAspectRatio', 'xMidYMid meet')
  picture.append(...lines(ahead, pencil, PAPER_INK))
  if (left) picture.append(svg('g', { transform: `translate(${shift} 0)` }, ...lines(left, pencil, PAPER_INK)))
  return picture
}

/** Make an address of a picture of strokes on white paper; it is for the caller to let go. */
export function paperUrl({ width, height }: Extent, strokes: Side): string {
  const picture = drawnOn({ width, height }, strokes, PAPER_INK)
  picture.prepend(svg('rect', { width, height, fill: PAPER.white }))
  for (const [name, value] of Object.entries({ width, height })) picture.setAttribute(name, String(value))
  const code = new XMLSerializer().serializeToString(picture)
  return URL.createObjectURL(new Blob([code], { type: 'image/svg+xml' }))
}

/** What strokes take up of their sheet; all of nothing is one pixel. */
function boxOf({ crown, branches }: Side): { left: number; right: number; top: number; bottom: number } {
  const all = [...(crown ?? []), ...branches.flatMap(({ points }) => points)]
  const [across, down] = [all.map(([x]) => x), all.map(([, y]) => y)]
  if (!all.length) return { left: 0, right: 1, top: 0, bottom: 1 }
  return { left: Math.min(...across), right: Math.max(...across), top: Math.min(...down), bottom: Math.max(...down) }
}

function lines({ crown, branches }: Side, pencil: number, inks: Inks): SVGElement[] {
  const round = { fill: 'none', 'stroke-linecap': 'round', 'stroke-linejoin': 'round' }
  const drawn = (kind: 'crown' | 'branch', points: Line, width = pencil) =>
    svg('path', { ...round, class: `pick-${kind}`, stroke: inks[kind], 'stroke-width': width, d: wayOf(points, kind) })
  const wood = branches.map(({ points, width }) => drawn('branch', points, Math.max(width ?? 0, pencil)))
  return [...(crown ? [drawn('crown', crown)] : []), ...wood]
}

function wayOf(points: Line, kind: 'crown' | 'branch'): string {
  return `M${points.map(point => point.join(' ')).join('L')}${kind === 'crown' ? 'z' : ''}`
}
