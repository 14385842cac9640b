import { along, distance } from '../plane'
import type { Selection, TraceAnswer, TracedSkeleton } from '../state'
import { type Line, lineOf, type Point, type StrokeKind, type StrokeRef, type Strokes, strokeRefs } from '../strokes'
import { branchAt } from '../tracedBranch'
import { INK, type Inks, WIDTH } from './ink'
import { drawLength } from './lengthLabel'
import { curve, foliagePath, rulerPath, smoothPath, woodAt, woodPath } from './paths'
import type { PenLine } from './penLine'
import type { View } from './viewport'

/** What a canvas of the window is drawn with: its device px per CSS px, and where the photo lies. */
export interface Sheet {
  readonly ctx: CanvasRenderingContext2D
  readonly density: number
  readonly view: View
}

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
export function drawTraced(sheet: Sheet, answer: TraceAnswer): void {
  const { ctx } = sheet
  onPhoto(sheet)
  const foliage = foliagePath(answer)
  // Small photos would drown in their leaves' outlines.
  const fine = Math.min(1, 0.4 + sheet.view.scale)
  ctx.lineJoin = 'round'
  outline(sheet, foliage, INK.foliageShade, fine * WIDTH.shade)
  ctx.fillStyle = INK.foliage
  ctx.fill(foliage, 'evenodd')
  outline(sheet, foliage, INK.foliageEdge, fine * WIDTH.edge)
  drawWood(sheet, answer.skeleton)
}

/** Draw the strokes, the mark on the one at fault, and what is selected or under the pointer. */
export function drawMarks(sheet: Sheet, marks: Marks, inks: Inks): void {
  onPhoto(sheet)
  sheet.ctx.lineCap = 'round'
  sheet.ctx.lineJoin = 'round'
  if (!same(marks.hovered, marks.selection)) drawHalo(sheet, marks, marks.hovered, inks.hoverHalo)
  drawHalo(sheet, marks, marks.fault, inks.faultHalo)
  drawHalo(sheet, marks, marks.selection, inks.selectedHalo)
  for (const ref of strokeRefs(marks.strokes)) {
    const colour = same(ref, marks.fault) ? inks.fault : same(ref, marks.selection) ? inks.selected : inks[ref.kind]
    const look = { kind: ref.kind, colour, casing: inks.casing, width: brushOf(marks.strokes, ref) }
    drawStroke(sheet, lineOf(marks.strokes, ref), pathOf(sheet, marks.strokes, ref), look)
  }
  // What is selected has its length in a field beside it.
  if (marks.strokes.scale && marks.selection?.kind !== 'scale') drawLength(sheet, marks.strokes.scale)
}

/** Draw the stroke under way. */
export function drawPenLine(sheet: Sheet, { points: line, kind, width }: PenLine, inks: Inks): void {
  onPhoto(sheet)
  sheet.ctx.lineCap = 'round'
  sheet.ctx.lineJoin = 'round'
  const path = kind === 'scale' ? rulerPath(line, TICK / sheet.view.scale) : curve(line)
  drawStroke(sheet, line, path, { kind, colour: inks[kind], casing: inks.casing, width: width ?? undefined })
}

/** Draw the crown that was taken where none was drawn. */
export function drawCrownTaken(sheet: Sheet, crown: Line, { crown: colour }: Inks): void {
  const [first] = crown
  if (!first) return
  onPhoto(sheet)
  sheet.ctx.lineCap = 'round'
  sheet.ctx.setLineDash(TAKEN_DASH.map(length => length / sheet.view.scale))
  outline(sheet, smoothPath(crown), colour, 1)
  outline(sheet, curve([crown.at(-1)!, first]), colour, 1)
  sheet.ctx.setLineDash([])
}

/** Draw where the keyboard's pen is. */
export function drawAim(sheet: Sheet, at: Point, penDown: boolean): void {
  onPhoto(sheet)
  const { scale } = sheet.view
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
  cased(sheet, path, { kind: 'branch', colour: INK.selected, casing: INK.casing })
}

/** Wood with a light rim; each part is cut out of what lies under it, so that the photo shows through. */
function drawWood({ ctx, view }: Sheet, skeleton: TracedSkeleton): void {
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

function drawStroke(sheet: Sheet, line: Line, path: Path2D, look: Look): void {
  cased(sheet, path, look)
  const [first, last] = [line[0], line.at(-1)]
  if (look.kind !== 'crown' || !first || !last || line.length < 3) return
  // The service closes a crown from its last point to its first.
  sheet.ctx.setLineDash(DASH.map(length => length / sheet.view.scale))
  cased(sheet, curve([last, first]), look)
  sheet.ctx.setLineDash([])
}

function cased(sheet: Sheet, path: Path2D, { kind, colour, casing, width = 0 }: Look): void {
  const wide = Math.max(WIDTH.line[kind], width * sheet.view.scale)
  outline(sheet, path, casing, wide + WIDTH.casing)
  outline(sheet, path, colour, wide)
}

function brushOf({ branches }: Strokes, { kind, index }: StrokeRef): number | undefined {
  return kind === 'branch' ? branches[index]?.width : undefined
}

function drawHalo(sheet: Sheet, marks: Marks, selection: Selection | null, colour: string): void {
  if (selection?.kind === 'traced') drawBranchHalo(sheet, marks.skeleton, selection.joint, colour)
  else if (selection) {
    const wide = (brushOf(marks.strokes, selection) ?? 0) * sheet.view.scale
    outline(sheet, pathOf(sheet, marks.strokes, selection), colour, wide + WIDTH.halo)
  }
}

function drawBranchHalo(sheet: Sheet, skeleton: TracedSkeleton | null, joint: number, colour: string): void {
  if (!skeleton || skeleton.stroke[joint] !== -1) return
  const { scale } = sheet.view
  const [joints, least] = [branchAt(skeleton, joint), WIDTH.thinnestWood / scale]
  sheet.ctx.fillStyle = colour
  sheet.ctx.fill(woodPath(skeleton, joints, least, WIDTH.halo / 3 / scale))
  inlay(sheet.ctx, woodPath(skeleton, joints, least, 0), INK.selectedWood)
}

function pathOf({ view }: Sheet, strokes: Strokes, ref: StrokeRef): Path2D {
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

function outline({ ctx, view }: Sheet, path: Path2D, colour: string, width: number): void {
  ctx.strokeStyle = colour
  ctx.lineWidth = width / view.scale
  ctx.stroke(path)
}

/** Draw in photo px from here on. */
function onPhoto({ ctx, density, view: { scale, x, y } }: Sheet): void {
  ctx.setTransform(density * scale, 0, 0, density * scale, density * x, density * y)
}

function same(one: Selection | null, other: Selection | null): boolean {
  if (!one || !other || one.kind === 'traced' || other.kind === 'traced') return sameJoint(one, other)
  return one.kind === other.kind && one.index === other.index
}

function sameJoint(one: Selection | null, other: Selection | null): boolean {
  return one?.kind === 'traced' && other?.kind === 'traced' && one.joint === other.joint
}
