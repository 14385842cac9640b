import type { TraceAnswer, TracedSkeleton } from '../api/types'
import { along, distance } from '../plane'
import type { Extent } from '../sheets'
import type { Selection } from '../state'
import { type Line, lineOf, type Point, type StrokeKind, type StrokeRef, type Strokes, strokeRefs } from '../strokes'
import { branchAt } from '../tracedBranch'
import type { DrawTarget } from './drawTarget'
import { INK, type Inks, WIDTH } from './ink'
import { drawLength } from './lengthLabel'
import { curve, foliagePath, rulerPath, smoothPath, woodAt, woodPath } from './paths'
import type { PenLine } from './penLine'

/** What the layer of the strokes shows. */
export interface Marks {
  readonly strokes: Strokes
  readonly skeleton: TracedSkeleton | null
  readonly selection: Selection | null
  readonly hovered: Selection | null
  readonly fault: StrokeRef | null
}

interface StrokeStyle {
  readonly kind: StrokeKind
  readonly colour: string
  readonly casing: string
  /** A brush's width, sheet px. */
  readonly width?: number | undefined
}

/** CSS px, as all sizes here. */
const DASH = [7, 6]
const ASSUMED_DASH = [2, 7]
const CROSS = 5
const TICK = 7
const CURSOR = { inner: 4, outer: 13 }

/** Draw what was traced on a sheet: the foliage's tint and the branches. A tree of many photos may reach beyond one of them. */
export function drawTraced(target: DrawTarget, answer: TraceAnswer, { width, height }: Extent): void {
  const { ctx } = target
  useSheetPixels(target)
  ctx.save()
  ctx.beginPath()
  ctx.rect(0, 0, width, height)
  ctx.clip()
  const foliage = foliagePath(answer)
  // Where a photo is shown small, full outlines would cover its leaves.
  const thinning = Math.min(1, 0.4 + target.view.scale)
  ctx.lineJoin = 'round'
  outline(target, foliage, INK.foliageShade, thinning * WIDTH.shade)
  ctx.fillStyle = INK.foliage
  ctx.fill(foliage, 'evenodd')
  outline(target, foliage, INK.foliageEdge, thinning * WIDTH.edge)
  drawWood(target, answer.skeleton)
  ctx.restore()
}

/** Draw the strokes, with halos around the one at fault, what is selected and what is under the pointer. */
export function drawMarks(target: DrawTarget, marks: Marks, inks: Inks): void {
  useSheetPixels(target)
  target.ctx.lineCap = 'round'
  target.ctx.lineJoin = 'round'
  if (!isSame(marks.hovered, marks.selection)) drawHalo(target, marks, marks.hovered, inks.hoverHalo)
  drawHalo(target, marks, marks.fault, inks.faultHalo)
  drawHalo(target, marks, marks.selection, inks.selectedHalo)
  for (const ref of strokeRefs(marks.strokes)) {
    const colour = isSame(ref, marks.fault) ? inks.fault : isSame(ref, marks.selection) ? inks.selected : inks[ref.kind]
    const style = { kind: ref.kind, colour, casing: inks.casing, width: brushOf(marks.strokes, ref) }
    drawStroke(target, lineOf(marks.strokes, ref), pathOf(target, marks.strokes, ref), style)
  }
  // A selected line's length is in the field beside it.
  if (marks.strokes.scale && marks.selection?.kind !== 'scale') drawLength(target, marks.strokes.scale)
}

/** Draw the stroke that is being drawn. */
export function drawPenLine(target: DrawTarget, { points: line, kind, width }: PenLine, inks: Inks): void {
  useSheetPixels(target)
  target.ctx.lineCap = 'round'
  target.ctx.lineJoin = 'round'
  const path = kind === 'scale' ? rulerPath(line, TICK / target.view.scale) : curve(line)
  drawStroke(target, line, path, { kind, colour: inks[kind], casing: inks.casing, width: width ?? undefined })
}

/** Draw the crown that was assumed because none was drawn. */
export function drawAssumedCrown(target: DrawTarget, crown: Line, { crown: colour }: Inks): void {
  const [first] = crown
  if (!first) return
  useSheetPixels(target)
  target.ctx.lineCap = 'round'
  target.ctx.setLineDash(ASSUMED_DASH.map(length => length / target.view.scale))
  outline(target, smoothPath(crown), colour, 1)
  outline(target, curve([crown.at(-1)!, first]), colour, 1)
  target.ctx.setLineDash([])
}

/** Draw the keyboard's cursor at a point of the sheet. */
export function drawCursor(target: DrawTarget, at: Point, penDown: boolean): void {
  useSheetPixels(target)
  const { scale } = target.view
  const path = new Path2D()
  for (const [right, down] of [
    [1, 0],
    [0, 1],
    [-1, 0],
    [0, -1],
  ] as const) {
    path.moveTo(at[0] + (right * CURSOR.inner) / scale, at[1] + (down * CURSOR.inner) / scale)
    path.lineTo(at[0] + (right * CURSOR.outer) / scale, at[1] + (down * CURSOR.outer) / scale)
  }
  if (penDown) path.arc(at[0], at[1], CURSOR.inner / scale, 0, 2 * Math.PI)
  drawCased(target, path, { kind: 'branch', colour: INK.selected, casing: INK.casing })
}

/** Draw wood with a light rim; each part is cut out of what lies under it, so that the photo shows through. */
function drawWood({ ctx, view }: DrawTarget, skeleton: TracedSkeleton): void {
  const { rim, stroked, found } = woodAt(skeleton, view.scale)
  ctx.fillStyle = INK.woodRim
  ctx.fill(rim)
  fillThrough(ctx, found, INK.woodFound)
  fillThrough(ctx, stroked, INK.woodStroked)
}

/** Replace what lies under a path by a colour. */
function fillThrough(ctx: CanvasRenderingContext2D, path: Path2D, colour: string): void {
  ctx.globalCompositeOperation = 'destination-out'
  ctx.fillStyle = '#000'
  ctx.fill(path)
  ctx.globalCompositeOperation = 'source-over'
  ctx.fillStyle = colour
  ctx.fill(path)
}

function drawStroke(target: DrawTarget, line: Line, path: Path2D, style: StrokeStyle): void {
  drawCased(target, path, style)
  const [first, last] = [line[0], line.at(-1)]
  if (style.kind !== 'crown' || !first || !last || line.length < 3) return
  // The service closes a crown from its last point to its first.
  target.ctx.setLineDash(DASH.map(length => length / target.view.scale))
  drawCased(target, curve([last, first]), style)
  target.ctx.setLineDash([])
}

function drawCased(target: DrawTarget, path: Path2D, { kind, colour, casing, width = 0 }: StrokeStyle): void {
  const linePx = Math.max(WIDTH.line[kind], width * target.view.scale)
  outline(target, path, casing, linePx + WIDTH.casing)
  outline(target, path, colour, linePx)
}

function brushOf({ branches }: Strokes, { kind, index }: StrokeRef): number | undefined {
  return kind === 'branch' ? branches[index]?.width : undefined
}

function drawHalo(target: DrawTarget, marks: Marks, selection: Selection | null, colour: string): void {
  if (selection?.kind === 'traced') drawBranchHalo(target, marks.skeleton, selection.joint, colour)
  else if (selection) {
    const brush = (brushOf(marks.strokes, selection) ?? 0) * target.view.scale
    outline(target, pathOf(target, marks.strokes, selection), colour, brush + WIDTH.halo)
  }
}

function drawBranchHalo(target: DrawTarget, skeleton: TracedSkeleton | null, joint: number, colour: string): void {
  if (!skeleton || skeleton.stroke[joint] !== -1) return
  const { scale } = target.view
  const [joints, minRadius] = [branchAt(skeleton, joint), WIDTH.thinnestWood / scale]
  target.ctx.fillStyle = colour
  target.ctx.fill(woodPath(skeleton, joints, minRadius, WIDTH.halo / 3 / scale))
  fillThrough(target.ctx, woodPath(skeleton, joints, minRadius, 0), INK.selectedWood)
}

function pathOf({ view }: DrawTarget, strokes: Strokes, ref: StrokeRef): Path2D {
  const line = lineOf(strokes, ref)
  if (ref.kind === 'scale') return rulerPath(line, TICK / view.scale)
  return ref.kind === 'erase' ? crossPath(line, CROSS / view.scale) : smoothPath(line)
}

/** Return a small cross at the middle of a line; `arm` in sheet px. */
function crossPath(line: Line, arm: number): Path2D {
  const path = new Path2D()
  const [x, y] = middleOf(line)
  path.moveTo(x - arm, y - arm)
  path.lineTo(x + arm, y + arm)
  path.moveTo(x - arm, y + arm)
  path.lineTo(x + arm, y - arm)
  return path
}

/** Return the point halfway along a line. */
function middleOf(line: Line): Point {
  const lengths = line.slice(1).map((point, index) => distance(line[index]!, point))
  let remaining = lengths.reduce((sum, length) => sum + length, 0) / 2
  for (const [index, length] of lengths.entries()) {
    if (remaining <= length && length > 0) return along([line[index]!, line[index + 1]!], remaining / length)
    remaining -= length
  }
  return line[0] ?? [0, 0]
}

/** Draw a path's line; `width` in CSS px. */
function outline({ ctx, view }: DrawTarget, path: Path2D, colour: string, width: number): void {
  ctx.strokeStyle = colour
  ctx.lineWidth = width / view.scale
  ctx.stroke(path)
}

/** Make sheet px the canvas's unit. */
function useSheetPixels({ ctx, density, view: { scale, x, y } }: DrawTarget): void {
  ctx.setTransform(density * scale, 0, 0, density * scale, density * x, density * y)
}

function isSame(one: Selection | null, other: Selection | null): boolean {
  if (!one || !other || one.kind === 'traced' || other.kind === 'traced') return isSameJoint(one, other)
  return one.kind === other.kind && one.index === other.index
}

function isSameJoint(one: Selection | null, other: Selection | null): boolean {
  return one?.kind === 'traced' && other?.kind === 'traced' && one.joint === other.joint
}
