import type { Ground, Photo, State } from './state'
import { type Line, lineOf, onSheet, type Point, type SheetName, type Side, type Strokes, strokeRefs } from './strokes'

/** Where a tree stands and where it ends, px down its sheet. */
export interface Levels {
  readonly root: number
  readonly top: number
}

/** How wide and high a sheet is, px. */
export interface Extent {
  readonly width: number
  readonly height: number
}

/** A new sheet of paper, px. */
const PAPER: Extent = { width: 900, height: 1200 }
/** Where a tree is expected on an empty sheet, as shares of its height. */
const EXPECTED: Levels = { root: 0.92, top: 0.08 }
/** Lines of the side that lie as near to the front's need no mention, as a share of the tree's height. */
const ALIKE = 0.04

/** Take white paper, as high as another sheet where there is one. */
export function paper(height = PAPER.height): Ground {
  return sheetOfSize({ width: Math.round((PAPER.width / PAPER.height) * height), height })
}

/** Take white paper of a size, px. */
export function sheetOfSize({ width, height }: Extent): Ground {
  return { id: null, width, height, file: null, url: null }
}

export function isPhoto(ground: Ground | null): ground is Photo {
  return ground !== null && ground.id !== null && ground.file !== null && ground.url !== null
}

/** Give what is drawn on; null where the sheet is not open. */
export function groundOf({ photo, side }: Pick<State, 'photo' | 'side'>, sheet: SheetName): Ground | null {
  return sheet === 'front' ? photo : side
}

/** Whether strokes lie on paper: the photo of a tree that is traced is none. */
export function isPaper({ source }: Pick<State, 'source'>, sheet: SheetName): boolean {
  return source === 'sketch' || sheet === 'side'
}

/** How wide the brush is on a sheet, px; null for a pencil. */
export function brushWidth({ brush }: Pick<State, 'brush'>, { height }: Extent): number | null {
  return brush === null ? null : Math.round(brush * height * 10) / 10
}

/** List the sheets that are open. */
export function openSheets({ side }: Pick<State, 'side'>): readonly SheetName[] {
  return side ? ['front', 'side'] : ['front']
}

/** Find where a sketched tree stands and ends; null before its first branch. */
export function levelsOf({ branches }: Side): Levels | null {
  const [trunk] = branches
  if (!trunk) return null
  const down = (line: Line) => line.map(([, y]) => y)
  return { root: Math.max(...down(trunk.points)), top: Math.min(...branches.flatMap(({ points }) => down(points))) }
}

/** Give the lines that run through all sheets, on one of them: those of the front's tree, or where one is expected. */
export function commonLevels(state: Pick<State, 'photo' | 'side' | 'history'>, sheet: SheetName): Levels | null {
  const [front, ground] = [state.photo, groundOf(state, sheet)]
  if (!front || !ground) return null
  const { root, top } = levelsOf(state.history.present) ?? scaled(EXPECTED, front.height)
  return scaled({ root, top }, ground.height / front.height)
}

/** Give the side's own lines where they lie elsewhere: its drawing will be brought to the front's height. */
export function strayLevels(state: Pick<State, 'photo' | 'side' | 'history'>): Levels | null {
  const common = commonLevels(state, 'side')
  const own = levelsOf(onSheet(state.history.present, 'side'))
  if (!common || !own) return null
  const apart = Math.max(Math.abs(own.root - common.root), Math.abs(own.top - common.top))
  return apart > ALIKE * (common.root - common.top) ? own : null
}

/** Move a drawing to a sheet of another size: as large as it fits there, in its middle. */
export function fittedTo<S extends Side>(drawn: S, from: Extent, to: Extent): S {
  const factor = Math.min(to.width / from.width, to.height / from.height)
  const [left, above] = [(to.width - factor * from.width) / 2, (to.height - factor * from.height) / 2]
  const move = ([x, y]: Point): Point => [left + factor * x, above + factor * y]
  const branches = drawn.branches.map(({ points, width }) => ({
    points: points.map(move),
    ...(width !== undefined && { width: factor * width }),
  }))
  return { ...drawn, crown: drawn.crown?.map(move) ?? null, branches }
}

/** Whether there are strokes on a sheet. */
export function isDrawn(strokes: Strokes, sheet: SheetName): boolean {
  const own = onSheet(strokes, sheet)
  return strokeRefs(own).some(ref => lineOf(own, ref).length > 0)
}

function scaled({ root, top }: Levels, factor: number): Levels {
  return { root: root * factor, top: top * factor }
}
