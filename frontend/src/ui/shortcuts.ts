import { isPaper } from '../sheets'
import type { Studio } from '../studio/studio'
import { nextBrush } from './brushes'
import { choose } from './intake'
import { saveProject } from './projectFile'
import { type Command, commandOf } from './shortcutKeys'
import { openShortcuts } from './shortcutSheet'
import type { Zoomed } from './zoombar'

/** Where keys write or have a meaning of their own. */
const TYPING = 'input, select, textarea, [contenteditable]'

/** Act on the page's keys, unless they are written into a field, or a dialog is open. */
export function listenToShortcuts(studio: Studio, sketch: Zoomed): void {
  const commands = commandsOf(studio, sketch)
  addEventListener('keydown', event => {
    const command = commandOf(event)
    if (!command || !isFree(event, command) || (!studio.store.state.photo && !['open', 'help'].includes(command)))
      return
    event.preventDefault()
    commands[command]()
  })
}

function commandsOf(studio: Studio, sketch: Zoomed): Readonly<Record<Command, () => unknown>> {
  const { store, sketchbook, grower, desk } = studio
  const brush = (steps: number) =>
    isPaper(store.state, store.state.sheet) && desk.takeBrush(nextBrush(store.state.brush, steps))
  return {
    crown: () => sketchbook.hold('crown'),
    branch: () => sketchbook.hold('branch'),
    scale: () => sketchbook.hold('scale'),
    select: () => sketchbook.hold('select'),
    other: () => turnToOther(studio),
    thinner: () => brush(-1),
    thicker: () => brush(1),
    undo: () => sketchbook.undo(),
    redo: () => sketchbook.redo(),
    remove: () => sketchbook.remove(),
    save: () => saveProject(studio),
    open: () => choose(studio),
    grow: () => grower.grow(),
    fit: () => sketch.fit(),
    actual: () => sketch.actual(),
    help: openShortcuts,
  }
}

/** Go to the other sheet, with the focus. */
function turnToOther({ store, desk }: Studio): void {
  if (!store.state.side) return
  const other = store.state.sheet === 'front' ? 'side' : 'front'
  desk.turnTo(other)
  document.querySelector<HTMLElement>(`.canvas > [data-sheet="${other}"]`)?.focus({ preventScroll: true })
}

function isFree(event: KeyboardEvent, command: Command): boolean {
  if (event.defaultPrevented || document.querySelector('dialog[open]')) return false
  const target = event.target instanceof Element ? event.target : document.body
  // The browser's own saving and opening would only be in the way.
  return ['save', 'open'].includes(command) || !target.closest(TYPING)
}
