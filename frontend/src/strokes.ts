import type { WireStrokes } from './api/types'

/** A place on a sheet, the upright photo or paper, pixels from the outer corner of its top-left one: x right, y down. */
export type Point = readonly [x: number, y: number]
export type Line = readonly Point[]

/** A stroke along a branch, from its parent outward; the first runs from the root up the trunk. */
export interface Branch {
  readonly points: Line
  /** Pixels. */
  readonly width?: number
}

/** A straight line over something of known length: its two ends, and its metres. */
export interface Scale {
  readonly points: Line
  readonly metres: number
}

/** What any side of a tree is drawn of. */
export interface Side {
  readonly crown: Line | null
  readonly branches: readonly Branch[]
}

/** What is drawn of a tree, seen from the front. Never changed in place: every edit gives a new value. */
export interface Strokes extends Side {
  /** Each crosses one traced branch that is to go. */
  readonly erase: readonly Line[]
  /** What sets the tree's scale in place of its height. */
  readonly scale: Scale | null
  /** What is drawn of it seen from its left, where anything is. */
  readonly side?: Side
}

/** A sheet to draw on: the tree from the front, or from its left. */
export type SheetName = 'front' | 'side'
export type StrokeKind = 'crown' | 'branch' | 'erase' | 'scale'

/** One stroke: the crown or the measured line, or a branch or an erase stroke by its place. */
export interface StrokeRef {
  readonly kind: StrokeKind
  readonly index: number
  /** Absent: it is on the front's sheet. */
  readonly sheet?: 'side'
}

export const NO_STROKES: Strokes = { crown: null, branches: [], erase: [], scale: null }

/** The strokes of one sheet, as if there were no other. */
export function onSheet(strokes: Strokes, sheet: SheetName): Strokes {
  const { side, ...front } = strokes
  if (sheet === 'side') return { ...NO_STROKES, ...side }
  return side ? front : strokes
}

/** Put strokes in the place of those of one sheet. */
export function withSheet(strokes: Strokes, sheet: SheetName, { crown, branches, ...others }: Strokes): Strokes {
  if (sheet === 'side') return { ...strokes, side: { crown, branches } }
  return { ...others, crown, branches, ...(strokes.side && { side: strokes.side }) }
}

/** Add a stroke, a branch perhaps of a brush's width (px); a second crown takes the first one's place. */
export function withStroke(
  strokes: Strokes,
  kind: Exclude<StrokeKind, 'scale'>,
  points: Line,
  width: number | null = null,
): Strokes {
  if (kind === 'crown') return { ...strokes, crown: points }
  const branch = { points, ...(width !== null && { width }) }
  if (kind === 'branch') return { ...strokes, branches: [...strokes.branches, branch] }
  return { ...strokes, erase: [...strokes.erase, points] }
}

/** Set the scale by a line of so many metres, in the place of another. */
export function withScale(strokes: Strokes, points: Line, metres: number): Strokes {
  return { ...strokes, scale: { points, metres } }
}

/** Leave a stroke out. */
export function withoutStroke(strokes: Strokes, { kind, index, sheet }: StrokeRef): Strokes {
  if (sheet) return withSheet(strokes, sheet, withoutStroke(onSheet(strokes, sheet), { kind, index }))
  if (kind === 'crown') return { ...strokes, crown: null }
  if (kind === 'branch') return { ...strokes, branches: strokes.branches.toSpliced(index, 1) }
  if (kind === 'scale') return { ...strokes, scale: null }
  return { ...strokes, erase: strokes.erase.toSpliced(index, 1) }
}

/** Name every stroke, in the order of drawing within its kind; the front's come first. */
export function strokeRefs(strokes: Strokes): StrokeRef[] {
  const of = (kind: StrokeKind, count: number) => Array.from({ length: count }, (_, index) => ({ kind, index }))
  return [
    ...of('crown', strokes.crown ? 1 : 0),
    ...of('branch', strokes.branches.length),
    ...of('erase', strokes.erase.length),
    ...of('scale', strokes.scale ? 1 : 0),
    ...(strokes.side ? strokeRefs(onSheet(strokes, 'side')).map(ref => onSide(ref)) : []),
  ]
}

function onSide(ref: StrokeRef): StrokeRef {
  return { ...ref, sheet: 'side' }
}

/** Give a stroke's points; none where there is no such stroke. */
export function lineOf(strokes: Strokes, { kind, index, sheet }: StrokeRef): Line {
  if (sheet) return lineOf(onSheet(strokes, sheet), { kind, index })
  if (kind === 'crown') return strokes.crown ?? []
  if (kind === 'branch') return strokes.branches[index]?.points ?? []
  if (kind === 'scale') return strokes.scale?.points ?? []
  return strokes.erase[index] ?? []
}

export function isEmpty(strokes: Strokes): boolean {
  return strokeRefs(strokes).length === 0
}

/** Write strokes as stroke files and the service have them; the service takes none without a crown. */
export function toWire({ crown, branches, erase, scale }: Strokes): Partial<WireStrokes> {
  return {
    ...(crown && { crown: { points: crown.map(toPair) } }),
    branches: branches.map(branch => ({ ...branch, points: branch.points.map(toPair) })),
    erase: erase.map(points => ({ points: points.map(toPair) })),
    ...(scale && { scale: { points: scale.points.map(toPair), metres: scale.metres } }),
  }
}

/** Read strokes from a stroke file, or throw a TypeError where they have another form. */
export function fromWire(value: unknown): Strokes {
  const { crown, branches, erase, scale } = fields(value)
  return {
    crown: crown === undefined ? null : line(fields(crown).points),
    branches: list(branches ?? []).map(branch => {
      const { points, width } = fields(branch)
      return { points: line(points), ...(typeof width === 'number' && { width }) }
    }),
    erase: list(erase ?? []).map(stroke => line(fields(stroke).points)),
    scale: scale === undefined || scale === null ? null : scaleFrom(fields(scale)),
  }
}

/** Read a measured line; there is none without its length. */
function scaleFrom({ points, metres }: Record<string, unknown>): Scale {
  if (typeof metres !== 'number' || !(metres > 0)) throw new TypeError('no length')
  const ends = line(points)
  if (ends.length !== 2) throw new TypeError('no straight line')
  return { points: ends, metres }
}

function toPair([x, y]: Point): [number, number] {
  return [x, y]
}

function fields(value: unknown): Record<string, unknown> {
  if (typeof value !== 'object' || value === null || Array.isArray(value)) throw new TypeError('no object')
  return value as Record<string, unknown>
}

function list(value: unknown): unknown[] {
  if (!Array.isArray(value)) throw new TypeError('no list')
  return value
}

function line(value: unknown): Line {
  return list(value).map(pair => {
    const [x, y, more] = list(pair)
    if (!Number.isFinite(x) || !Number.isFinite(y) || more !== undefined) throw new TypeError('no point')
    return [x, y] as Point
  })
}

/** Find the stroke that a JSON pointer leads to: /crown, /strokes/erase/0, /branches/2/points, /sketches/side/crown. */
export function strokeAt(pointer: string | null): StrokeRef | null {
  const found = pointer?.match(
    /^(?:\/(?:strokes|sketches))?(?:\/(front|side))?\/(crown|branches|erase|scale)(?:\/(\d+))?/,
  )
  if (!found) return null
  const kind = found[2] === 'branches' ? 'branch' : (found[2] as StrokeKind)
  return { kind, index: Number(found[3] ?? 0), ...(found[1] === 'side' && { sheet: 'side' }) }
}
