import { Sketch } from '../sketch/sketch'
import type { View } from '../sketch/viewport'
import type { Studio } from '../studio/studio'
import { text } from '../text'
import { announceDrawing, announcePen } from './announcer'
import { divider } from './divider'
import { button, el } from './dom'
import { mountHintLine } from './hintLine'
import { lengthField } from './lengthField'
import { mountPreviewPane } from './previewpane'
import { toolbar } from './toolbar'
import { type Zoomed, zoombar } from './zoombar'
import './workspace.css'

type Shown = 'drawing' | 'both' | 'tree'

/** Lay out the drawing and the tree; both stay while the page does. */
export function mountWorkspace(studio: Studio, main: HTMLElement): Zoomed {
  const tree = el('section', { class: 'pane tree-pane', 'aria-label': text.workspace.tree })
  const drawing = el('section', { class: 'pane drawing-pane', 'aria-label': text.workspace.drawing })
  const workspace = el('div', { class: 'workspace', 'data-shows': 'both' })
  workspace.append(drawing, divider(workspace), chooser(workspace), tree)
  main.append(workspace)
  const sketch = mountDrawing(studio, drawing)
  mountPreviewPane(studio, tree)
  announceDrawing(studio.store)
  turnWith(studio, workspace, main)
  return sketch
}

/** Show the workspace while a photo is open; the keyboard goes on where the work does, as what was clicked is gone. */
function turnWith({ store }: Studio, workspace: HTMLElement, main: HTMLElement): void {
  workspace.hidden = store.state.photo === null
  store.watch(
    state => state.photo === null,
    closed => {
      if (closed === workspace.hidden) return
      workspace.hidden = closed
      const place = closed ? main : workspace.querySelector<HTMLElement>('.canvas > *')
      place?.focus({ preventScroll: true })
    },
  )
}

function mountDrawing(studio: Studio, pane: HTMLElement): Zoomed {
  const hints = el('div', { class: 'hint-row' })
  const canvas = el('div', { class: 'canvas' })
  const zoom = zoombar(() => sketch)
  const length = lengthField(studio, () => canvas.querySelector<HTMLElement>('[data-view]'))
  pane.append(toolbar(studio), hints, canvas, zoom.bar)
  mountHintLine(studio, hints)
  const { store, sketchbook } = studio
  const events = {
    drew: sketchbook.draw.bind(sketchbook),
    selected: sketchbook.select.bind(sketchbook),
    remove: () => sketchbook.remove(),
    looked: (view: View) => {
      zoom.show(view.scale)
      length.look(view)
    },
    said: ({ pen, at }: { pen: 'down' | 'up' | 'move'; at: readonly [number, number] }) =>
      store.state.photo && announcePen(pen, at, store.state.photo),
  }
  const labels = { canvas: text.workspace.canvas, keys: text.workspace.canvasKeys }
  const sketch = new Sketch(canvas, store, events, labels)
  canvas.append(length.element)
  return sketch
}

/** Make the switch that gives the drawing or the tree the whole height of a phone. */
function chooser(workspace: HTMLElement): HTMLElement {
  const row = el('div', { class: 'chooser', role: 'group', 'aria-label': text.workspace.show })
  const labels: Record<Shown, string> = {
    drawing: text.workspace.drawing,
    both: text.workspace.both,
    tree: text.workspace.treeShort,
  }
  const show = (shown: Shown) => {
    workspace.dataset.shows = shown
    for (const one of row.children) one.setAttribute('aria-pressed', String(one.getAttribute('data-show') === shown))
  }
  for (const shown of Object.keys(labels) as Shown[]) {
    row.append(button({ class: 'button', 'data-show': shown }, () => show(shown), labels[shown]))
  }
  show('both')
  return row
}
