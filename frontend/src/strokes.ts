import type { WireCaptureStrokes, WireFrameStrokes, WireStrokes } from './api/types'
import type { Edit } from './edits'

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
  /** The photo that it was drawn over, where there are many. */
  readonly photo?: string
}

/** How far apart two photos were taken, metres. */
export interface PhotoDistance {
  readonly photos: readonly [string, string]
  readonly metres: number
}

/** What is drawn on one sheet: the parts that both sheets have. */
export interface Side {
  readonly crown: Line | null
  readonly branches: readonly Branch[]
}

/** What is drawn over one photo of many. */
export interface PhotoStrokes extends Side {
  /** The photo's name. */
  readonly photo: string
  readonly erase: readonly Line[]
}

/** All that is drawn of a tree: on its front and its `side`, or over many photos. Never changed in place: every edit returns a new value. */
export interface Strokes extends Side {
  /** Each crosses one traced branch, which is removed. */
  readonly erase: readonly Line[]
  /** The measured line, which sets the tree's scale in place of its height. */
  readonly scale: Scale | null
  /** The strokes of the side's sheet. */
  readonly side?: Side
  /** What is drawn over each photo of many, in the order in which they were first drawn over; the front has nothing then. */
  readonly views?: readonly PhotoStrokes[]
  /** Edits of the branches that many photos show, in the order in which they were made. */
  readonly edits?: readonly Edit[]
  /** The frame of a clip that is drawn over, from 0; absent where no clip is open. */
  readonly frame?: number
  /** What sets the scale of a tree of many photos in place of a measured line. */
  readonly distance?: PhotoDistance
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
  /** The photo's name, where there are many. */
  readonly photo?: string
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

/** Return the strokes over one photo of many alone. */
export function onPhoto({ views = [], scale }: Strokes, photo: string): Strokes {
  const { crown = null, branches = [], erase = [] } = views.find(view => view.photo === photo) ?? {}
  return { crown, branches, erase, scale: scale?.photo === photo ? scale : null }
}

/** Return the strokes with those over one photo of many replaced. */
export function withPhoto(strokes: Strokes, photo: string, { crown, branches, erase, scale }: Strokes): Strokes {
  const { views = [], distance, ...others } = strokes
  const own = crown || branches.length || erase.length ? [{ photo, crown, branches, erase }] : []
  const isDrawn = views.some(view => view.photo === photo)
  const kept = isDrawn ? views.flatMap(view => (view.photo === photo ? own : [view])) : [...views, ...own]
  const measured = scale ? { ...scale, photo } : strokes.scale?.photo === photo ? null : strokes.scale
  return { ...others, views: kept, scale: measured, ...(distance && !measured && { distance }) }
}

/** Return the strokes with the distance between two photos as their scale; without one (null) the height counts. */
export function withDistance({ distance: _, ...strokes }: Strokes, distance: PhotoDistance | null): Strokes {
  return distance ? { ...strokes, scale: null, distance } : strokes
}

/** Return the strokes drawn over a frame of a clip, from 0, in place of another. */
export function withFrame(strokes: Strokes, frame: number): Strokes {
  return { ...strokes, frame }
}

/** Return no strokes, over the same frame of a clip. */
export function cleared({ frame }: Strokes): Strokes {
  return frame === undefined ? NO_STROKES : { ...NO_STROKES, frame }
}

/** Return the strokes with one more edit of the branches. */
export function withEdit(strokes: Strokes, edit: Edit): Strokes {
  return { ...strokes, edits: [...(strokes.edits ?? []), edit] }
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
export function withScale({ distance: _, ...strokes }: Strokes, points: Line, metres: number): Strokes {
  return { ...strokes, scale: { points, metres } }
}

/** Return the strokes without one of them. */
export function withoutStroke(strokes: Strokes, { kind, index, sheet, photo }: StrokeRef): Strokes {
  if (photo !== undefined) return withPhoto(strokes, photo, withoutStroke(onPhoto(strokes, photo), { kind, index }))
  if (sheet) return withSheet(strokes, sheet, withoutStroke(onSheet(strokes, sheet), { kind, index }))
  if (kind === 'crown') return { ...strokes, crown: null }
  if (kind === 'branch') return { ...strokes, branches: strokes.branches.toSpliced(index, 1) }
  if (kind === 'scale') return { ...strokes, scale: null }
  return { ...strokes, erase: strokes.erase.toSpliced(index, 1) }
}

/** Return references to all strokes, by sheet, then by kind in the order in which they were drawn; the front's come first. */
export function strokeRefs(strokes: Strokes): StrokeRef[] {
  if (strokes.views) return photosDrawnOver(strokes).flatMap(photo => refsOver(strokes, photo))
  const of = (kind: StrokeKind, count: number) => Array.from({ length: count }, (_, index) => ({ kind, index }))
  return [
    ...of('crown', strokes.crown ? 1 : 0),
    ...of('branch', strokes.branches.length),
    ...of('erase', strokes.erase.length),
    ...of('scale', strokes.scale ? 1 : 0),
    ...(strokes.side ? strokeRefs(onSheet(strokes, 'side')).map(ref => onSide(ref)) : []),
  ]
}

/** Return the names of the photos that something is drawn over. */
export function photosDrawnOver({ views = [], scale }: Strokes): string[] {
  return [...new Set([...views.map(({ photo }) => photo), ...(scale?.photo === undefined ? [] : [scale.photo])])]
}

function refsOver(strokes: Strokes, photo: string): StrokeRef[] {
  return strokeRefs(onPhoto(strokes, photo)).map(ref => ({ ...ref, photo }))
}

function onSide(ref: StrokeRef): StrokeRef {
  return { ...ref, sheet: 'side' }
}

/** Return a stroke's points; empty where there is no such stroke. */
export function lineOf(strokes: Strokes, { kind, index, sheet, photo }: StrokeRef): Line {
  if (photo !== undefined) return lineOf(onPhoto(strokes, photo), { kind, index })
  if (sheet) return lineOf(onSheet(strokes, sheet), { kind, index })
  if (kind === 'crown') return strokes.crown ?? []
  if (kind === 'branch') return strokes.branches[index]?.points ?? []
  if (kind === 'scale') return strokes.scale?.points ?? []
  return strokes.erase[index] ?? []
}

/** Return whether there is no stroke on any sheet, and no edit. */
export function isEmpty(strokes: Strokes): boolean {
  return strokeRefs(strokes).length === 0 && !strokes.edits?.length && !strokes.distance
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

/** Return the strokes over a frame of a clip in the form of files and requests. */
export function frameToWire({ frame = 0, ...strokes }: Strokes): Partial<WireFrameStrokes> {
  return { frame, ...toWire(strokes) }
}

/** Return the strokes over a frame of a clip that a file holds; throws a TypeError where it has another form. */
export function frameFromWire(value: unknown): Strokes {
  const { frame } = fields(value)
  return withFrame(fromWire(value), typeof frame === 'number' ? frame : 0)
}

/** Return the strokes over many photos in the form of files and requests: those over photos with a crown. */
export function viewsToWire({ views = [], scale, distance }: Strokes): WireCaptureStrokes {
  const drawn = views.flatMap(({ photo, ...own }) => {
    const { crown, ...others } = toWire({ ...own, scale: null })
    return crown ? [{ photo, crown, ...others }] : []
  })
  const line = scale?.photo !== undefined && {
    photo: scale.photo,
    points: scale.points.map(toPair),
    metres: scale.metres,
  }
  const apart = distance && { ...distance, photos: [...distance.photos] as [string, string] }
  const chosen = line || apart
  return { views: drawn, ...(chosen && { scale: chosen }) }
}

/** Return the strokes over many photos that a file holds; throws a TypeError where it has another form. */
export function viewsFromWire(value: unknown): Strokes {
  const { views, scale } = fields(value)
  const drawn = list(views).map(view => {
    const { scale: _, ...own } = fromWire(view)
    return { ...own, photo: String(fields(view).photo) }
  })
  const strokes: Strokes = { ...NO_STROKES, views: drawn }
  if (scale === undefined || scale === null) return strokes
  const { photo, photos, metres } = fields(scale)
  if (photos === undefined) return { ...strokes, scale: { ...scaleFrom(fields(scale)), photo: String(photo) } }
  const [from, to] = list(photos).map(String)
  return withDistance(strokes, { photos: [from!, to!], metres: positive(metres) })
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
  const ends = line(points)
  if (ends.length !== 2) throw new TypeError('a measured line must have two points')
  return { points: ends, metres: positive(metres) }
}

function positive(metres: unknown): number {
  if (typeof metres !== 'number' || !(metres > 0)) throw new TypeError('metres must be a positive number')
  return metres
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

/**
 * Return the stroke that a JSON pointer refers to: /crown, /strokes/erase/0, /branches/2/points, /sketches/side/crown, and
 * with the views of many photos /views/1/branches/0 or /views/views/1/crown.
 */
export function strokeAt(pointer: string | null, views: readonly PhotoStrokes[] = []): StrokeRef | null {
  const [, place, rest] = pointer?.match(/^(?:\/views)?\/views\/(\d+)(\/.*)?$/) ?? []
  const over = place === undefined ? undefined : views[Number(place)]
  if (over) return { ...(strokeAt(rest ?? null) ?? { kind: 'crown', index: 0 }), photo: over.photo }
  const found = pointer?.match(
    /^(?:\/(?:strokes|sketches))?(?:\/(front|side))?\/(crown|branches|erase|scale)(?:\/(\d+))?/,
  )
  if (!found) return null
  const kind = found[2] === 'branches' ? 'branch' : (found[2] as StrokeKind)
  return { kind, index: Number(found[3] ?? 0), ...(found[1] === 'side' && { sheet: 'side' }) }
}
