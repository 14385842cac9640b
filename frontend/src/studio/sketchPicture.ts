import type { Client } from '../api/client'
import type { components } from '../api/schema'
import type { Limits, StrokeWarning, TracedSkeleton } from '../api/types'
import { distance, simplified } from '../plane'
import { type Branch, type Line, NO_STROKES } from '../strokes'
import { text } from '../text'
import { sentenceOf, Unusable } from './faultText'
import { isPng } from './png'
import { type SketchFile, sketchFrom } from './sketches'

/** Branches that the service takes as strokes. */
const MOST_BRANCHES = 199
/** As far as a stroke may leave the line that was read, as a share of the picture's longer side. */
const APART = 0.0004

/** Read a sketch, from a PNG of its strokes or from JSON, or throw `Unusable` where it is neither. */
export async function readSketch(file: Blob, client: Client, limits: Limits | null): Promise<SketchFile> {
  if (!(await isPng(file))) return fromJson(file)
  const most = limits?.sketch_bytes ?? Number.POSITIVE_INFINITY
  if (file.size > most) throw new Unusable(text.faults.fileTooLarge(file.size, most))
  const { front, warnings } = await client.traceDrawing(file)
  return sketchIn(
    front,
    warnings.filter(({ stroke }) => stroke.startsWith('front')),
  )
}

/** Turn what a picture shows into strokes, one for each branch, as wide as its brush was on the whole. */
export function sketchIn(
  { skeleton, crown, crown_drawn, size }: components['schemas']['TracedSketch'],
  warnings: readonly StrokeWarning[] = [],
): SketchFile {
  const [width, height] = size
  const all = branchesOf(skeleton, APART * Math.max(width, height))
  const branches = longest(all, bearersOf(skeleton), MOST_BRANCHES)
  const corrections = [...correctionsFrom(warnings), ...leftOut(all.length - branches.length)].join(' ')
  const strokes = { ...NO_STROKES, crown: crown_drawn ? crown : null, branches }
  return { strokes, size: { width, height }, ...(corrections && { corrections }) }
}

async function fromJson(file: Blob): Promise<SketchFile> {
  try {
    return sketchFrom(JSON.parse(await file.text()))
  } catch {
    throw new Unusable(text.faults.sketchUnreadable)
  }
}

/** The trunk comes first, and each branch after its bearer, from whose line it goes out. */
function branchesOf({ points, radii, parents, stroke }: TracedSkeleton, apart: number): Branch[] {
  return grouped(stroke).map(joints => {
    const bud = points[parents[joints[0]!]!]
    const line = [...(bud ? [bud] : []), ...joints.map(joint => points[joint]!)]
    const width = Math.round(20 * median(joints.map(joint => radii[joint]!))) / 10
    return { points: simplified(line, apart), ...(width > 0 && { width }) }
  })
}

/** List the joints of every branch, outward. */
function grouped(stroke: readonly number[]): number[][] {
  const joints: number[][] = []
  for (const [joint, branch] of stroke.entries()) {
    joints[branch] ??= []
    joints[branch].push(joint)
  }
  return joints
}

/** Give every branch's bearer; -1 for the trunk. */
function bearersOf({ parents, stroke }: TracedSkeleton): number[] {
  return grouped(stroke).map(([first]) => stroke[parents[first!]!] ?? -1)
}

/** Keep so many branches, the longest with all that bear them. */
function longest(branches: readonly Branch[], bearers: readonly number[], most: number): Branch[] {
  const reach = branches.map(({ points }) => lengthOf(points))
  for (let branch = branches.length - 1; branch > 0; branch--) {
    const bearer = bearers[branch]!
    reach[bearer] = Math.max(reach[bearer]!, reach[branch]!)
  }
  const ranked = [...branches.keys()].toSorted((one, other) => reach[other]! - reach[one]!)
  const kept = new Set(ranked.slice(0, most))
  return branches.filter((_, branch) => kept.has(branch))
}

function lengthOf(line: Line): number {
  return line.slice(1).reduce((length, place, at) => length + distance(line[at]!, place), 0)
}

function median(values: readonly number[]): number {
  return values.toSorted((one, other) => one - other)[Math.floor(values.length / 2)]!
}

function correctionsFrom(warnings: readonly StrokeWarning[]): string[] {
  const { corrected } = text.sheets
  return [...new Set(warnings.map(({ code }) => code))].map(code => {
    const alike = warnings.filter(warning => warning.code === code)
    const known = (corrected as Readonly<Record<string, (count: number) => string>>)[code]
    return known ? known(alike.length) : alike.map(({ detail }) => sentenceOf(detail)).join(' ')
  })
}

function leftOut(count: number): string[] {
  return count > 0 ? [text.sheets.leftOut(count, MOST_BRANCHES)] : []
}
