import type { TracedSkeleton } from '../api/types'
import type { Sheet, Store } from '../state'
import type { Point } from '../strokes'
import { text } from '../text'
import { editSaid } from './edits'
import { announce } from './live'
import { strokeName } from './strokeNames'

/** Have screen readers say what the eye sees on the photo: tools, strokes, what was found. */
export function announceDrawing(store: Store): void {
  let history = store.state.history
  store.watch(
    state => state.history,
    now => {
      const said = editSaid(history, now)
      history = now
      if (said) announce(said)
    },
  )
  let sheet = store.state.sheet
  store.watch(
    state => state.sheet,
    now => {
      if (now !== sheet && store.state.side) announce(text.sheets.turnedTo[now])
      sheet = now
    },
  )
  let tool = store.state.tool
  store.watch(
    state => state.tool,
    now => {
      if (now !== tool && store.state.photo) announce(text.tools.taken[now])
      tool = now
    },
  )
  store.watch(
    state => state.traced,
    traced => traced && announce(text.strokes.branchesFound(tipCount(traced.answer.skeleton))),
  )
  store.watch(
    state => state.selection,
    selection => selection && announce(text.strokes.selected(strokeName(selection))),
  )
}

/** Say what the keyboard's pen does, at a place of the photo in pixels. */
export function announcePen(pen: 'down' | 'up' | 'move', [x, y]: Point, { width, height }: Sheet): void {
  const right = Math.round((x / width) * 100)
  const down = Math.round((y / height) * 100)
  if (pen === 'up') announce(text.strokes.penUp)
  else announce(pen === 'down' ? text.strokes.penDown(right, down) : text.strokes.penAt(right, down))
}

/** Count the ends of what was traced: as many branches does the eye see. */
function tipCount({ parents }: TracedSkeleton): number {
  const bearing = new Set(parents)
  return parents.filter((_, joint) => !bearing.has(joint)).length
}
