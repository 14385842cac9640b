import { isPaper } from '../../sheets'
import type { Studio } from '../../studio/studio'
import { choose } from '../parts/files'
import { saveProject } from '../parts/saving'
import { type Command, commandOf } from '../parts/shortcutKeys'
import { nextBrush } from './DrawingFoot'
import type { Zoom } from './sheetSketches'

/** Elements that use keys themselves. */
const TYPING = 'input, select, textarea, [contenteditable]'

/** Run the commands of the page's keys, but not in fields or under a dialog; the call ends it. */
export function listenToShortcuts(studio: Studio, zoom: Zoom, turnToOther: () => void): () => void {
  const commands = commandsOf(studio, zoom, turnToOther)
  const press = (event: KeyboardEvent) => {
    const command = commandOf(event)
    if (!command || !isFree(event, command)) return
    if (!studio.store.state.sheets && !['open', 'help'].includes(command)) return
    event.preventDefault()
    commands[command]()
  }
  addEventListener('keydown', press)
  return () => removeEventListener('keydown', press)
}

function commandsOf(studio: Studio, zoom: Zoom, turnToOther: () => void): Readonly<Record<Command, () => unknown>> {
  const { store, strokes, grower, sheets } = studio
  const brush = (steps: number) =>
    isPaper(store.state, store.state.active) && sheets.chooseBrush(nextBrush(store.state.brush, steps))
  return {
    crown: () => strokes.chooseTool('crown'),
    branch: () => strokes.chooseTool('branch'),
    scale: () => strokes.chooseTool('scale'),
    select: () => strokes.chooseTool('select'),
    other: turnToOther,
    thinner: () => brush(-1),
    thicker: () => brush(1),
    undo: () => strokes.undo(),
    redo: () => strokes.redo(),
    remove: () => strokes.remove(),
    save: () => saveProject(studio),
    open: () => choose(studio),
    grow: () => grower.grow(),
    fit: () => zoom.fit(),
    actual: () => zoom.actual(),
    help: () => store.set({ dialog: 'shortcuts' }),
  }
}

function isFree(event: KeyboardEvent, command: Command): boolean {
  if (event.defaultPrevented || document.querySelector('dialog[open]')) return false
  const target = event.target instanceof Element ? event.target : document.body
  // The browser would save or open the page itself.
  return ['save', 'open'].includes(command) || !target.closest(TYPING)
}
