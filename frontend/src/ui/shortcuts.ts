import type { Studio } from '../studio/studio'
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
  const { sketchbook, grower } = studio
  return {
    crown: () => sketchbook.hold('crown'),
    branch: () => sketchbook.hold('branch'),
    scale: () => sketchbook.hold('scale'),
    select: () => sketchbook.hold('select'),
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

function isFree(event: KeyboardEvent, command: Command): boolean {
  if (event.defaultPrevented || document.querySelector('dialog[open]')) return false
  const target = event.target instanceof Element ? event.target : document.body
  // The browser's own saving and opening would only be in the way.
  return ['save', 'open'].includes(command) || !target.closest(TYPING)
}
