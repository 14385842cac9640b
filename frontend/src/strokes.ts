import type { WireStrokes } from './api/types'

/** A point of a sheet, px from its top left corner, x right, y down; a pixel's centre is at .5. */
export type Point = readonly [x: number, y: number]
export type Line = readonly Point[]

/** A stroke along a branch, from its parent outward; the first runs from the root up the trunk. */
export interface Branch {
  readonly points: Line
  /** The brush's width, px. */
  readonly width?: number
}

/** A measured line: the two ends of something in the photo, and its length in metres. */
export interface Scale {
  readonly points: Line
  readonly metres: number
}

/** What is drawn on one sheet: the parts that both sheets have. */
export interface Side {
  readonly crown: Line | null
  readonly branches: readonly Branch[]
}

/** All strokes of a tree: those of the front, and its `side`. Never changed in place: every edit returns a new value. */
export interface Strokes extends Side {
  /** Each crosses one traced branch, which is removed. */
  readonly erase: readonly Line[]
  /** The measured line, which sets the tree's scale in place of its height. */
  readonly scale: Scale | null
  /** The strokes of the side's sheet. */
  readonly side?: Side
}

/** A sheet's name: the tree from the front, or from its left. */
export type SheetName = 'front' | 'side'
export type StrokeKind = 'crown' | 'branch' | 'erase' | 'scale'

/** Refers to one stroke: by its kind, and for branches and erase strokes its index. */
export interface StrokeRef {
  readonly kind: StrokeKind
  readonly index: number
  /** Absent for the front's sheet. */
  readonly sheet?: 'side'
}

export const NO_STROKES: Strokes = { crown: null, branches: [], erase: [], scale: null }

/** Return the strokes of one sheet alone. */
export function onSheet(strokes: Strokes, sheet: SheetName): Strokes {
  const { side, ...front } = strokes
  if (sheet === 'side') return { ...NO_STROKES, ...side }
  return side ? front : strokes
}

/** Return the strokes with those of one sheet replaced. */
export function withSheet(strokes: Strokes, sheet: SheetName, { crown, branches, ...others }: Strokes): Strokes {
  if (sheet === 'side') return { ...strokes, side: { crown, branches } }
  return { ...others, crown, branches, ...(strokes.side && { side: strokes.side }) }
}

/** Return the strokes with one more, a branch perhaps with a brush's width (px); a second crown replaces the first. */
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

/** Return the strokes with a measured line of this length, in place of another. */
export function withScale(strokes: Strokes, points: Line, metres: number): Strokes {
  return { ...strokes, scale: { points, metres } }
}

/** Return the strokes without one of them. */
export function withoutStroke(strokes: Strokes, { kind, index, sheet }: StrokeRef): Strokes {
  if (sheet) return withSheet(strokes, sheet, withoutStroke(onSheet(strokes, sheet), { kind, index }))
  if (kind === 'crown') return { ...strokes, crown: null }
  if (kind === 'branch') return { ...strokes, branches: strokes.branches.toSpliced(index, 1) }
  if (kind === 'scale') return { ...strokes, scale: null }
  return { ...strokes, erase: strokes.erase.toSpliced(index, 1) }
}

/** Return references to all strokes, by kind, in the order in which they were drawn; the front's come first. */
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

/** Return a stroke's points; empty where there is no such stroke. */
export function lineOf(strokes: Strokes, { kind, index, sheet }: StrokeRef): Line {
  if (sheet) return lineOf(onSheet(strokes, sheet), { kind, index })
  if (kind === 'crown') return strokes.crown ?? []
  if (kind === 'branch') return strokes.branches[index]?.points ?? []
  if (kind === 'scale') return strokes.scale?.points ?? []
  return strokes.erase[index] ?? []
}

/** Return whether there is no stroke on any sheet. */
export function isEmpty(strokes: Strokes): boolean {
  return strokeRefs(strokes).length === 0
}

/** Return the front's strokes in the form of stroke files and requests; the service needs a crown among them. */
export function toWire({ crown, branches, erase, scale }: Strokes): Partial<WireStrokes> {
  return {
    ...(crown && { crown: { points: crown.map(toPair) } }),
    branches: branches.map(branch => ({ ...branch, points: branch.points.map(toPair) })),
    erase: erase.map(points => ({ points: points.map(toPair) })),
    ...(scale && { scale: { points: scale.points.map(toPair), metres: scale.metres } }),
  }
}

/** Return the strokes in a stroke file; throws a TypeError where it has another form. */
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

/** Return a measured line; throws a TypeError without a length. */
function scaleFrom({ points, metres }: Record<string, unknown>): Scale {
  if (typeof metres !== 'number' || !(metres > 0)) throw new TypeError('metres must be a positive number')
  const ends = line(points)
  if (ends.length !== 2) throw new TypeError('a measured line must have two points')
  return { points: ends, metres }
}

function toPair([x, y]: Point): [number, number] {
  return [x, y]
}

function fields(value: unknown): Record<string, unknown> {
  if (typeof value !== 'object' || value === null || Array.isArray(value)) throw new TypeError('not an object')
  return value as Record<string, unknown>
}

function list(value: unknown): unknown[] {
  if (!Array.isArray(value)) throw new TypeError('not a list')
  return value
}

function line(value: unknown): Line {
  return list(value).map(pair => {
    const [x, y, more] = list(pair)
    if (!Number.isFinite(x) || !Number.isFinite(y) || more !== undefined)
      throw new TypeError('not a point: two numbers are needed')
    return [x, y] as Point
  })
}

/** Return the stroke that a JSON pointer refers to: /crown, /strokes/erase/0, /branches/2/points, /sketches/side/crown. */
export function strokeAt(pointer: string | null): StrokeRef | null {
  const found = pointer?.match(
    /^(?:\/(?:strokes|sketches))?(?:\/(front|side))?\/(crown|branches|erase|scale)(?:\/(\d+))?/,
  )
  if (!found) return null
  const kind = found[2] === 'branches' ? 'branch' : (found[2] as StrokeKind)
  return { kind, index: Number(found[3] ?? 0), ...(found[1] === 'side' && { sheet: 'side' }) }
}
