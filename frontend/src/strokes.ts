import type { components } from './api/schema'

/** A place in the upright photo, pixels from the outer corner of its top-left pixel: x right, y down. */
export type Point = readonly [x: number, y: number]
export type Line = readonly Point[]

/** A stroke along a branch, from its parent outward; the first runs from the root up the trunk. */
export interface Branch {
  readonly points: Line
  /** Pixels. */
  readonly width?: number
}

/** What is drawn over a photo. Never changed in place: every edit gives a new value. */
export interface Strokes {
  readonly crown: Line | null
  readonly branches: readonly Branch[]
  /** Each crosses one traced branch that is to go. */
  readonly erase: readonly Line[]
}

export type StrokeKind = 'crown' | 'branch' | 'erase'

/** One stroke: the crown, or a branch or an erase stroke by its place. */
export interface StrokeRef {
  readonly kind: StrokeKind
  readonly index: number
}

type WireStrokes = components['schemas']['Strokes']

export const NO_STROKES: Strokes = { crown: null, branches: [], erase: [] }

/** Add a stroke; a second crown takes the first one's place. */
export function withStroke(strokes: Strokes, kind: StrokeKind, points: Line): Strokes {
  if (kind === 'crown') return { ...strokes, crown: points }
  if (kind === 'branch') return { ...strokes, branches: [...strokes.branches, { points }] }
  return { ...strokes, erase: [...strokes.erase, points] }
}

/** Leave a stroke out. */
export function withoutStroke(strokes: Strokes, { kind, index }: StrokeRef): Strokes {
  if (kind === 'crown') return { ...strokes, crown: null }
  if (kind === 'branch') return { ...strokes, branches: strokes.branches.toSpliced(index, 1) }
  return { ...strokes, erase: strokes.erase.toSpliced(index, 1) }
}

/** Name every stroke, in the order of drawing within its kind. */
export function strokeRefs(strokes: Strokes): StrokeRef[] {
  const of = (kind: StrokeKind, count: number) => Array.from({ length: count }, (_, index) => ({ kind, index }))
  return [
    ...of('crown', strokes.crown ? 1 : 0),
    ...of('branch', strokes.branches.length),
    ...of('erase', strokes.erase.length),
  ]
}

/** Give a stroke's points; none where there is no such stroke. */
export function lineOf(strokes: Strokes, { kind, index }: StrokeRef): Line {
  if (kind === 'crown') return strokes.crown ?? []
  if (kind === 'branch') return strokes.branches[index]?.points ?? []
  return strokes.erase[index] ?? []
}

export function isEmpty(strokes: Strokes): boolean {
  return strokeRefs(strokes).length === 0
}

/** Write strokes as stroke files and the service have them; the service takes none without a crown. */
export function toWire({ crown, branches, erase }: Strokes): Partial<WireStrokes> {
  return {
    ...(crown && { crown: { points: crown.map(toPair) } }),
    branches: branches.map(branch => ({ ...branch, points: branch.points.map(toPair) })),
    erase: erase.map(points => ({ points: points.map(toPair) })),
  }
}

/** Read strokes from a stroke file, or throw a TypeError where they have another form. */
export function fromWire(value: unknown): Strokes {
  const { crown, branches, erase } = fields(value)
  return {
    crown: crown === undefined ? null : line(fields(crown).points),
    branches: list(branches ?? []).map(branch => {
      const { points, width } = fields(branch)
      return { points: line(points), ...(typeof width === 'number' && { width }) }
    }),
    erase: list(erase ?? []).map(stroke => line(fields(stroke).points)),
  }
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
