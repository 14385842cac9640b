import type { TraceAnswer, TracedSkeleton } from '../api/types'
import { along, distance } from '../plane'
import type { Selection } from '../state'
import { type Line, lineOf, type Point, type StrokeKind, type StrokeRef, type Strokes, strokeRefs } from '../strokes'
import { branchAt } from '../tracedBranch'
import type { DrawTarget } from './drawTarget'
import { INK, type Inks, WIDTH } from './ink'
import { drawLength } from './lengthLabel'
import { curve, foliagePath, rulerPath, smoothPath, woodAt, woodPath } from './paths'
import type { PenLine } from './penLine'

/** What the strokes' layer shows. */
export interface Marks {
  readonly strokes: Strokes
  readonly skeleton: TracedSkeleton | null
  readonly selection: Selection | null
  readonly hovered: Selection | null
  readonly fault: StrokeRef | null
}

interface Look {
  readonly kind: StrokeKind
  readonly colour: string
  readonly casing: string
  /** A brush's width, photo px. */
  readonly width?: number | undefined
}

const DASH = [7, 6]
const TAKEN_DASH = [2, 7]
const CROSS = 5
const TICK = 7
const AIM = { inner: 4, outer: 13 }

/** Draw what was traced: the foliage's tint and the branches. */
export function drawTraced(target: DrawTarget, answer: TraceAnswer): void {
  const { ctx } = target
  onPhoto(target)
  const foliage = foliagePath(answer)
  // Small photos would drown in their leaves' outlines.
  const fine = Math.min(1, 0.4 + target.view.scale)
  ctx.lineJoin = 'round'
  outline(target, foliage, INK.foliageShade, fine * WIDTH.shade)
  ctx.fillStyle = INK.foliage
  ctx.fill(foliage, 'evenodd')
  outline(target, foliage, INK.foliageEdge, fine * WIDTH.edge)
  drawWood(target, answer.skeleton)
}

/** Draw the strokes, the mark on the one at fault, and what is selected or under the pointer. */
export function drawMarks(target: DrawTarget, marks: Marks, inks: Inks): void {
  onPhoto(target)
  target.ctx.lineCap = 'round'
  target.ctx.lineJoin = 'round'
  if (!same(marks.hovered, marks.selection)) drawHalo(target, marks, marks.hovered, inks.hoverHalo)
  drawHalo(target, marks, marks.fault, inks.faultHalo)
  drawHalo(target, marks, marks.selection, inks.selectedHalo)
  for (const ref of strokeRefs(marks.strokes)) {
    const colour = same(ref, marks.fault) ? inks.fault : same(ref, marks.selection) ? inks.selected : inks[ref.kind]
    const look = { kind: ref.kind, colour, casing: inks.casing, width: brushOf(marks.strokes, ref) }
    drawStroke(target, lineOf(marks.strokes, ref), pathOf(target, marks.strokes, ref), look)
  }
  // What is selected has its length in a field beside it.
  if (marks.strokes.scale && marks.selection?.kind !== 'scale') drawLength(target, marks.strokes.scale)
}

/** Draw the stroke under way. */
export function drawPenLine(target: DrawTarget, { points: line, kind, width }: PenLine, inks: Inks): void {
  onPhoto(target)
  target.ctx.lineCap = 'round'
  target.ctx.lineJoin = 'round'
  const path = kind === 'scale' ? rulerPath(line, TICK / target.view.scale) : curve(line)
  drawStroke(target, line, path, { kind, colour: inks[kind], casing: inks.casing, width: width ?? undefined })
}

/** Draw the crown that was taken where none was drawn. */
export function drawCrownTaken(target: DrawTarget, crown: Line, { crown: colour }: Inks): void {
  const [first] = crown
  if (!first) return
  onPhoto(target)
  target.ctx.lineCap = 'round'
  target.ctx.setLineDash(TAKEN_DASH.map(length => length / target.view.scale))
  outline(target, smoothPath(crown), colour, 1)
  outline(target, curve([crown.at(-1)!, first]), colour, 1)
  target.ctx.setLineDash([])
}

/** Draw where the keyboard's pen is. */
export function drawAim(target: DrawTarget, at: Point, penDown: boolean): void {
  onPhoto(target)
  const { scale } = target.view
  const path = new Path2D()
  for (const [right, down] of [
    [1, 0],
    [0, 1],
    [-1, 0],
    [0, -1],
  ] as const) {
    path.moveTo(at[0] + (right * AIM.inner) / scale, at[1] + (down * AIM.inner) / scale)
    path.lineTo(at[0] + (right * AIM.outer) / scale, at[1] + (down * AIM.outer) / scale)
  }
  if (penDown) path.arc(at[0], at[1], AIM.inner / scale, 0, 2 * Math.PI)
  cased(target, path, { kind: 'branch', colour: INK.selected, casing: INK.casing })
}

/** Wood with a light rim; each part is cut out of what lies under it, so that the photo shows through. */
function drawWood({ ctx, view }: DrawTarget, skeleton: TracedSkeleton): void {
  const { rim, stroked, found } = woodAt(skeleton, view.scale)
  ctx.fillStyle = INK.woodRim
  ctx.fill(rim)
  inlay(ctx, found, INK.woodFound)
  inlay(ctx, stroked, INK.woodStroked)
}

function inlay(ctx: CanvasRenderingContext2D, path: Path2D, colour: string): void {
  ctx.globalCompositeOperation = 'destination-out'
  ctx.fillStyle = '#000'
  ctx.fill(path)
  ctx.globalCompositeOperation = 'source-over'
  ctx.fillStyle = colour
  ctx.fill(path)
}

function drawStroke(target: DrawTarget, line: Line, path: Path2D, look: Look): void {
  cased(target, path, look)
  const [first, last] = [line[0], line.at(-1)]
  if (look.kind !== 'crown' || !first || !last || line.length < 3) return
  // The service closes a crown from its last point to its first.
  target.ctx.setLineDash(DASH.map(length => length / target.view.scale))
  cased(target, curve([last, first]), look)
  target.ctx.setLineDash([])
}

function cased(target: DrawTarget, path: Path2D, { kind, colour, casing, width = 0 }: Look): void {
  const wide = Math.max(WIDTH.line[kind], width * target.view.scale)
  outline(target, path, casing, wide + WIDTH.casing)
  outline(target, path, colour, wide)
}

function brushOf({ branches }: Strokes, { kind, index }: StrokeRef): number | undefined {
  return kind === 'branch' ? branches[index]?.width : undefined
}

function drawHalo(target: DrawTarget, marks: Marks, selection: Selection | null, colour: string): void {
  if (selection?.kind === 'traced') drawBranchHalo(target, marks.skeleton, selection.joint, colour)
  else if (selection) {
    const wide = (brushOf(marks.strokes, selection) ?? 0) * target.view.scale
    outline(target, pathOf(target, marks.strokes, selection), colour, wide + WIDTH.halo)
  }
}

function drawBranchHalo(target: DrawTarget, skeleton: TracedSkeleton | null, joint: number, colour: string): void {
  if (!skeleton || skeleton.stroke[joint] !== -1) return
  const { scale } = target.view
  const [joints, least] = [branchAt(skeleton, joint), WIDTH.thinnestWood / scale]
  target.ctx.fillStyle = colour
  target.ctx.fill(woodPath(skeleton, joints, least, WIDTH.halo / 3 / scale))
  inlay(target.ctx, woodPath(skeleton, joints, least, 0), INK.selectedWood)
}

function pathOf({ view }: DrawTarget, strokes: Strokes, ref: StrokeRef): Path2D {
  const line = lineOf(strokes, ref)
  if (ref.kind === 'scale') return rulerPath(line, TICK / view.scale)
  return ref.kind === 'erase' ? crossPath(line, CROSS / view.scale) : smoothPath(line)
}

/** A small cross at the middle of a line. */
function crossPath(line: Line, arm: number): Path2D {
  const path = new Path2D()
  const [x, y] = middleOf(line)
  path.moveTo(x - arm, y - arm)
  path.lineTo(x + arm, y + arm)
  path.moveTo(x - arm, y + arm)
  path.lineTo(x + arm, y - arm)
  return path
}

function middleOf(line: Line): Point {
  const lengths = line.slice(1).map((point, index) => distance(line[index]!, point))
  let left = lengths.reduce((sum, length) => sum + length, 0) / 2
  for (const [index, length] of lengths.entries()) {
    if (left <= length && length > 0) return along([line[index]!, line[index + 1]!], left / length)
    left -= length
  }
  return line[0] ?? [0, 0]
}

function outline({ ctx, view }: DrawTarget, path: Path2D, colour: string, width: number): void {
  ctx.strokeStyle = colour
  ctx.lineWidth = width / view.scale
  ctx.stroke(path)
}

/** Draw in photo px from here on. */
function onPhoto({ ctx, density, view: { scale, x, y } }: DrawTarget): void {
  ctx.setTransform(density * scale, 0, 0, density * scale, density * x, density * y)
}

function same(one: Selection | null, other: Selection | null): boolean {
  if (!one || !other || one.kind === 'traced' || other.kind === 'traced') return sameJoint(one, other)
  return one.kind === other.kind && one.index === other.index
}

function sameJoint(one: Selection | null, other: Selection | null): boolean {
  return one?.kind === 'traced' && other?.kind === 'traced' && one.joint === other.joint
}
