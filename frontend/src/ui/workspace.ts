import type { SheetName } from '../strokes'
import type { Studio } from '../studio/studio'
import { text } from '../text'
import { announceDrawing } from './announcer'
import { deskFoot } from './brushes'
import { divider } from './divider'
import { button, el } from './dom'
import { mountHintLine } from './hintLine'
import { mountPreviewPane } from './previewpane'
import { mountSheets } from './sheets'
import { toolbar } from './toolbar'
import { type Zoomed, zoombar } from './zoombar'
import './workspace.css'

type Shown = 'drawing' | 'both' | 'tree'
/** What the switch gives the whole height of a phone: with one sheet, and with two. */
type Choice = Shown | SheetName
const ONE: readonly Choice[] = ['drawing', 'both', 'tree']
const TWO: readonly Choice[] = ['front', 'side', 'tree']

/** Lay out the drawing and the tree; both stay while the page does. */
export function mountWorkspace(studio: Studio, main: HTMLElement): Zoomed {
  const tree = el('section', { class: 'pane tree-pane', 'aria-label': text.workspace.tree })
  const drawing = el('section', { class: 'pane drawing-pane', 'aria-label': text.workspace.drawing })
  const workspace = el('div', { class: 'workspace', 'data-shows': 'both' })
  workspace.append(drawing, divider(workspace), chooser(studio, workspace), tree)
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
  const zoom = zoombar(() => sheets)
  const sheets = mountSheets(studio, scale => zoom.show(scale))
  pane.append(toolbar(studio), hints, sheets.element, deskFoot(studio), zoom.bar)
  mountHintLine(studio, hints)
  return sheets
}

/** Make the switch that gives a sheet or the tree the whole height of a phone. */
function chooser({ store, desk }: Studio, workspace: HTMLElement): HTMLElement {
  const labels: Record<Choice, string> = {
    drawing: text.workspace.drawing,
    both: text.workspace.both,
    ...text.sheets.tabs,
  }
  let shown: Shown = 'both'
  const buttons = (Object.keys(labels) as Choice[]).map(choice =>
    button({ class: 'button', 'data-show': choice }, () => show(choice), labels[choice]),
  )
  const mark = () => {
    const { side, sheet } = store.state
    const [choices, chosen] = side ? [TWO, shown === 'tree' ? 'tree' : sheet] : [ONE, shown]
    workspace.dataset.shows = shown
    workspace.classList.toggle('two-sheets', side !== null)
    for (const one of buttons) {
      const choice = one.dataset.show as Choice
      one.hidden = !choices.includes(choice)
      one.setAttribute('aria-pressed', String(choice === chosen))
    }
  }
  store.watch(
    state => state.side !== null,
    two => {
      shown = two ? 'drawing' : 'both'
      mark()
    },
  )
  store.watch(state => state.sheet, mark)
  // Two sheets leave no room for the tree beside them; who has it grown wants to see it.
  store.watch(
    ({ asking, side }) => asking && side !== null,
    grows => grows && show('tree'),
  )
  return el('div', { class: 'chooser', role: 'group', 'aria-label': text.workspace.show }, ...buttons)

  function show(choice: Choice): void {
    if (choice === 'front' || choice === 'side') desk.turnTo(choice)
    shown = choice === 'front' || choice === 'side' ? 'drawing' : choice
    mark()
  }
}
