import { groundOf, isPaper } from '../sheets'
import { Sketch } from '../sketch/sketch'
import type { View } from '../sketch/viewport'
import type { State } from '../state'
import type { SheetName } from '../strokes'
import type { Studio } from '../studio/studio'
import { text } from '../text'
import { announcePen } from './announcer'
import { el } from './dom'
import { type LengthField, lengthField } from './lengthField'
import { sheetHeading } from './sheetHeading'
import './sheets.css'
import type { Zoomed } from './zoombar'

const SHEETS = ['front', 'side'] as const

/** Both sheets side by side, and what looks at them: the zoom goes for both. */
export interface Sheets extends Zoomed {
  readonly element: HTMLElement
}

/** Lay out the sheets of the front and of the left side; `zoomed` is told the scale, CSS px per px of the one in use. */
export function mountSheets(studio: Studio, zoomed: (scale: number) => void): Sheets {
  const { store } = studio
  const canvases = { front: el('div', { class: 'canvas' }), side: el('div', { class: 'canvas' }) }
  const parts = SHEETS.map(name => {
    const part = el('div', { class: 'sheet-part', 'data-of': name }, sheetHeading(studio, name), canvases[name])
    store.watch(
      state => groundOf(state, name) !== null,
      open => {
        part.hidden = !open && name === 'side'
      },
    )
    return part
  })
  const element = el('div', { class: 'sheets' }, ...parts)
  store.watch(
    state => state.sheet,
    sheet => {
      element.dataset.active = sheet
    },
  )
  const length = lengthField(studio, () => canvases.front.querySelector<HTMLElement>('[data-sheet]'))
  const sketches = sketchesOn(studio, canvases, { length, zoomed })
  canvases.front.append(length.element)
  const inUse = () => sketches[store.state.sheet]
  return {
    element,
    fit: () => inUse().fit(),
    actual: () => inUse().actual(),
    zoom: factor => inUse().zoom(factor),
  }
}

/** What follows the view of the sheets. */
interface Followers {
  readonly length: LengthField
  readonly zoomed: (scale: number) => void
}

function sketchesOn(
  studio: Studio,
  canvases: Readonly<Record<SheetName, HTMLElement>>,
  { length, zoomed }: Followers,
): Record<SheetName, Sketch> {
  const { store, sketchbook, desk } = studio
  const made: Partial<Record<SheetName, Sketch>> = {}
  const looked = (sheet: SheetName, view: View, whole: boolean) => {
    if (store.state.sheet === sheet) zoomed(view.scale)
    if (sheet === 'front') length.look(view)
    const other = sheet === 'front' ? 'side' : 'front'
    const [own, its] = [groundOf(store.state, sheet), groundOf(store.state, other)]
    if (own && its) made[other]?.follow({ scale: (view.scale * own.height) / its.height, y: view.y }, whole)
  }
  for (const sheet of SHEETS) {
    const events = {
      touched: () => desk.turnTo(sheet),
      drew: (...[kind, points]: Parameters<typeof sketchbook.draw>) => sketchbook.draw(kind, points, sheet),
      selected: sketchbook.select.bind(sketchbook),
      remove: () => sketchbook.remove(),
      looked: (view: View, whole: boolean) => looked(sheet, view, whole),
      said: ({ pen, at }: { pen: 'down' | 'up' | 'move'; at: readonly [number, number] }) =>
        announcePen(pen, at, groundOf(store.state, sheet)!),
    }
    made[sheet] = new Sketch(canvases[sheet], store, events, { sheet, ...labelsOf(sheet, store.state) })
  }
  store.watch(
    state => state.source,
    () => {
      for (const sheet of SHEETS) made[sheet]?.name(labelsOf(sheet, store.state))
    },
  )
  return made as Record<SheetName, Sketch>
}

/** Name a sheet by what it is: a photo or paper. */
function labelsOf(sheet: SheetName, { source }: State): { canvas: string; keys: string } {
  const { workspace, sheets } = text
  return isPaper({ source }, sheet)
    ? { canvas: sheets.canvas[sheet], keys: sheets.canvasKeys }
    : { canvas: workspace.canvas, keys: workspace.canvasKeys }
}
