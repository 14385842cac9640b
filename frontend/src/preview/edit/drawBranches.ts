import { beyond } from '../../branches'

/** Branches on the screen: joints in CSS px with their depth and radius. */
interface Drawn {
  readonly points: readonly (readonly [x: number, y: number, depth: number, radius: number])[]
  readonly radii: readonly number[]
  readonly parents: readonly number[]
  readonly seen: readonly boolean[]
}

/** Colours that stand out before a photo, sky and leaves. */
const EDGE = 'rgb(18 24 18 / 60%)'
const SEEN = '#ffe27a'
const JOINING = '#ffb04d'
const SELECTED = '#ff5a2b'
/** Widths of lines, CSS px: the least, the most, and how far the dark edge reaches beyond. */
const [LEAST, MOST, BEYOND] = [1.6, 14, 1.2]
const KNOB = 7
/** Dashes of branches that no photo shows, CSS px. */
const DASHES = [5, 4]

/** Draw branches, the part from the selected joint on in another colour, and the line of one that is drawn from there. */
export function drawBranches(
  ctx: CanvasRenderingContext2D,
  branches: Drawn,
  { selected, line }: { selected: number | null; line: readonly (readonly [number, number])[] },
): void {
  const marked = selected === null ? [] : beyond(branches, selected)
  ctx.lineCap = 'round'
  const edges = [...branches.parents.keys()].filter(joint => isBefore(branches, joint))
  for (const joint of edges) strokeEdge(ctx, branches, joint, { colour: EDGE, beyond: 2 * BEYOND })
  for (const joint of edges) {
    const isMarked = marked[joint] && joint !== selected
    const colour = isMarked ? SELECTED : branches.seen[joint] ? SEEN : JOINING
    strokeEdge(ctx, branches, joint, { colour, beyond: 0 })
  }
  const knob = selected === null ? undefined : branches.points[selected]
  if (!knob) return
  drawLine(ctx, [[knob[0], knob[1]], ...line])
  drawKnob(ctx, knob)
}

function isBefore({ points, parents }: Drawn, joint: number): boolean {
  const parent = points[parents[joint]!]
  return parent !== undefined && parent[2] > 0 && points[joint]![2] > 0
}

function strokeEdge(
  ctx: CanvasRenderingContext2D,
  { points, parents, seen }: Drawn,
  joint: number,
  { colour, beyond: more }: { colour: string; beyond: number },
): void {
  const [from, to] = [points[parents[joint]!]!, points[joint]!]
  ctx.strokeStyle = colour
  ctx.lineWidth = Math.min(Math.max(2 * to[3], LEAST), MOST) + more
  ctx.setLineDash(seen[joint] ? [] : DASHES)
  ctx.beginPath()
  ctx.moveTo(from[0], from[1])
  ctx.lineTo(to[0], to[1])
  ctx.stroke()
}

function drawKnob(ctx: CanvasRenderingContext2D, [x, y]: readonly [number, number, ...number[]]): void {
  ctx.setLineDash([])
  ctx.beginPath()
  ctx.arc(x, y, KNOB, 0, 2 * Math.PI)
  ctx.fillStyle = '#ffffff'
  ctx.fill()
  ctx.lineWidth = 3
  ctx.strokeStyle = SELECTED
  ctx.stroke()
}

function drawLine(ctx: CanvasRenderingContext2D, line: readonly (readonly [number, number])[]): void {
  if (line.length < 2) return
  ctx.setLineDash([])
  ctx.lineWidth = 4
  ctx.strokeStyle = SELECTED
  ctx.beginPath()
  for (const [x, y] of line) ctx.lineTo(x, y)
  ctx.stroke()
}
