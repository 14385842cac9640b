import type { Client } from '../api/client'
import type { components } from '../api/schema'
import type { Limits, StrokeWarning, TracedSkeleton } from '../api/types'
import { distance, simplified } from '../plane'
import { type Branch, type Line, NO_STROKES } from '../strokes'
import { text } from '../text'
import { PageFault, sentenceOf } from './faultText'
import { isPng } from './png'
import { type SketchFile, sketchFrom } from './sketches'

/** How many branches the service accepts as strokes. */
const MAX_BRANCHES = 199
/** How far a simplified stroke may lie from the line that was read, as a share of the picture's longer side. */
const TOLERANCE = 0.0004

/** Return the sketch in a file, a PNG of its strokes or JSON; throws `PageFault` where it is neither. */
export async function readSketch(file: Blob, client: Client, limits: Limits | null): Promise<SketchFile> {
  if (!(await isPng(file))) return fromJson(file)
  const most = limits?.sketch_bytes ?? Number.POSITIVE_INFINITY
  if (file.size > most) throw new PageFault(text.faults.fileTooLarge(file.size, most))
  const { front, warnings } = await client.traceDrawing(file)
  return sketchIn(
    front,
    warnings.filter(({ stroke }) => stroke.startsWith('front')),
  )
}

/** Return what was read from a picture as strokes, one for each branch, with the median width of its line. */
export function sketchIn(
  { skeleton, crown, crown_drawn, size }: components['schemas']['TracedSketch'],
  warnings: readonly StrokeWarning[] = [],
): SketchFile {
  const [width, height] = size
  const all = branchesOf(skeleton, TOLERANCE * Math.max(width, height))
  const branches = longest(all, parentBranchesOf(skeleton), MAX_BRANCHES)
  const corrections = [...correctionsFrom(warnings), ...leftOut(all.length - branches.length)].join(' ')
  const strokes = { ...NO_STROKES, crown: crown_drawn ? crown : null, branches }
  return { strokes, size: { width, height }, ...(corrections && { corrections }) }
}

async function fromJson(file: Blob): Promise<SketchFile> {
  try {
    return sketchFrom(JSON.parse(await file.text()))
  } catch {
    throw new PageFault(text.faults.sketchUnreadable)
  }
}

/** Return the trunk, then each branch after its parent branch, on whose line it starts; `tolerance` in px. */
function branchesOf({ points, radii, parents, stroke }: TracedSkeleton, tolerance: number): Branch[] {
  return jointsByBranch(stroke).map(joints => {
    const start = points[parents[joints[0]!]!]
    const line = [...(start ? [start] : []), ...joints.map(joint => points[joint]!)]
    const width = Math.round(20 * median(joints.map(joint => radii[joint]!))) / 10
    return { points: simplified(line, tolerance), ...(width > 0 && { width }) }
  })
}

/** Return the joints of each branch, outward. */
function jointsByBranch(stroke: readonly number[]): number[][] {
  const joints: number[][] = []
  for (const [joint, branch] of stroke.entries()) {
    joints[branch] ??= []
    joints[branch].push(joint)
  }
  return joints
}

/** Return each branch's parent branch; -1 for the trunk. */
function parentBranchesOf({ parents, stroke }: TracedSkeleton): number[] {
  return jointsByBranch(stroke).map(([first]) => stroke[parents[first!]!] ?? -1)
}

/** Return the longest branches, each with its parent branches; at most `limit`. */
function longest(branches: readonly Branch[], parents: readonly number[], limit: number): Branch[] {
  // A branch counts as long as the longest that it leads to.
  const ranks = branches.map(({ points }) => lengthOf(points))
  for (let branch = branches.length - 1; branch > 0; branch--) {
    const parent = parents[branch]!
    ranks[parent] = Math.max(ranks[parent]!, ranks[branch]!)
  }
  const ranked = [...branches.keys()].toSorted((one, other) => ranks[other]! - ranks[one]!)
  const kept = new Set(ranked.slice(0, limit))
  return branches.filter((_, branch) => kept.has(branch))
}

function lengthOf(line: Line): number {
  return line.slice(1).reduce((length, place, at) => length + distance(line[at]!, place), 0)
}

function median(values: readonly number[]): number {
  return values.toSorted((one, other) => one - other)[Math.floor(values.length / 2)]!
}

/** Return what was corrected, one sentence for each kind of warning. */
function correctionsFrom(warnings: readonly StrokeWarning[]): string[] {
  const { corrected } = text.sheets
  return [...new Set(warnings.map(({ code }) => code))].map(code => {
    const alike = warnings.filter(warning => warning.code === code)
    const known = (corrected as Readonly<Record<string, (count: number) => string>>)[code]
    return known ? known(alike.length) : alike.map(({ detail }) => sentenceOf(detail)).join(' ')
  })
}

function leftOut(count: number): string[] {
  return count > 0 ? [text.sheets.leftOut(count, MAX_BRANCHES)] : []
}
