import { render } from 'preact'
import { type Extent, fittedTo } from '../../sheets'
import { INK, type Inks, PAPER, PAPER_INK } from '../../sketch/ink'
import type { Line, Side, Strokes } from '../../strokes'

/** Of a pencil's line, as a share of the sheet's height. */
const PENCIL = 0.0035
/** Between two sides, as a share of their height. */
const GAP = 0.12

interface Box {
  readonly left: number
  readonly right: number
  readonly top: number
  readonly bottom: number
}

/** One sheet's strokes as a picture of the sheet's size, on a transparent ground. */
export function SheetPicture({ size: { width, height }, strokes }: { readonly size: Extent; readonly strokes: Side }) {
  return (
    <svg viewBox={`0 0 ${width} ${height}`} preserveAspectRatio="xMidYMid slice" aria-hidden="true">
      <Lines strokes={strokes} pencil={PENCIL * height} inks={INK} />
    </svg>
  )
}

interface PairProps {
  readonly front: Extent
  readonly strokes: Strokes
  /** The side's sheet, where it is open. */
  readonly side: Extent | null
}

/** Both sides of a tree beside each other, as high as each other, with as much paper as they need. */
export function PairPicture({ front, strokes, side }: PairProps) {
  const { side: drawn, ...ahead } = strokes
  const scaled = side && { ...front, width: (side.width * front.height) / side.height }
  const left = side && scaled && drawn ? fittedTo(drawn, side, scaled) : null
  const [one, other] = [boxOf(ahead), left && boxOf(left)]
  const [top, bottom] = [Math.min(one.top, other?.top ?? one.top), Math.max(one.bottom, other?.bottom ?? one.bottom)]
  const height = bottom - top
  const shift = other ? one.right + GAP * height - other.left : 0
  const width = (other ? other.right + shift : one.right) - one.left
  const pencil = PENCIL * Math.max(height, width) * 2
  return (
    <svg viewBox={[one.left, top, width, height].join(' ')} preserveAspectRatio="xMidYMid meet" aria-hidden="true">
      <Lines strokes={ahead} pencil={pencil} inks={PAPER_INK} />
      {left && (
        <g transform={`translate(${shift} 0)`}>
          <Lines strokes={left} pencil={pencil} inks={PAPER_INK} />
        </g>
      )}
    </svg>
  )
}

/** Return the address of a picture of strokes on white paper, an SVG; the caller revokes it. */
export function paperUrl({ width, height }: Extent, strokes: Side): string {
  const made = document.createElement('div')
  render(
    <svg viewBox={`0 0 ${width} ${height}`} width={width} height={height} aria-hidden="true">
      <rect width={width} height={height} fill={PAPER.white} />
      <Lines strokes={strokes} pencil={PENCIL * height} inks={PAPER_INK} />
    </svg>,
    made,
  )
  const code = new XMLSerializer().serializeToString(made.firstElementChild!)
  return URL.createObjectURL(new Blob([code], { type: 'image/svg+xml' }))
}

/** Return what strokes cover of their sheet; one pixel where there are no strokes. */
function boxOf({ crown, branches }: Side): Box {
  const all = [...(crown ?? []), ...branches.flatMap(({ points }) => points)]
  const [across, down] = [all.map(([x]) => x), all.map(([, y]) => y)]
  if (!all.length) return { left: 0, right: 1, top: 0, bottom: 1 }
  return { left: Math.min(...across), right: Math.max(...across), top: Math.min(...down), bottom: Math.max(...down) }
}

interface LinesProps {
  readonly strokes: Side
  /** The least width of a line, px of the sheet. */
  readonly pencil: number
  readonly inks: Inks
}

function Lines({ strokes: { crown, branches }, pencil, inks }: LinesProps) {
  const round = { fill: 'none', 'stroke-linecap': 'round', 'stroke-linejoin': 'round' } as const
  return (
    <>
      {crown && (
        <path {...round} class="pick-crown" stroke={inks.crown} stroke-width={pencil} d={`${pathOf(crown)}z`} />
      )}
      {branches.map(({ points, width }, index) => (
        <path
          {...round}
          key={index}
          class="pick-branch"
          stroke={inks.branch}
          stroke-width={Math.max(width ?? 0, pencil)}
          d={pathOf(points)}
        />
      ))}
    </>
  )
}

function pathOf(points: Line): string {
  return `M${points.map(point => point.join(' ')).join('L')}`
}
