import type { TracedSkeleton } from '../../api/types'
import type { History } from '../../history'
import type { Selection, Sheet, State, Store } from '../../state'
import { isEmpty, lineOf, type Point, type Scale, type StrokeRef, type Strokes, strokeRefs } from '../../strokes'
import { text } from '../../text'
import { captureProgress } from '../capture/captureStatus'
import { strokeName } from './strokeTexts'

/** Announce the tool, the sheet and the selection that are chosen, edits, and what was traced; the call ends it. */
export function announceDrawing(store: Store): () => void {
  const say = <T>(select: (state: State) => T, sentence: (now: T, before: T) => string | null) => {
    let before = select(store.state)
    return store.watch(select, now => {
      const said = now === before ? null : sentence(now, before)
      before = now
      if (said) store.announce(said)
    })
  }
  const ends = [
    say(
      state => state.history,
      (now, before) => editText(before, now),
    ),
    say(
      state => state.active,
      sheet => (store.state.sheets?.side ? text.sheets.activated[sheet] : null),
    ),
    say(
      state => state.tool,
      tool => (store.state.sheets ? text.tools.chosen[tool] : null),
    ),
    say(
      state => state.traced,
      traced => traced && text.strokes.branchesFound(tipCount(traced.answer.skeleton)),
    ),
    say(
      state => state.solve?.status,
      status => (status === 'solved' ? (captureProgress(store.state)?.words ?? null) : null),
    ),
    say(
      state => state.selection,
      (now, before) => (now && !isSame(now, before) ? text.strokes.selected(strokeName(now)) : null),
    ),
  ]
  return () => {
    for (const end of ends) end()
  }
}

/** Announce what the keyboard's pen does, at a place of a sheet in pixels. */
export function announcePen(store: Store, pen: 'down' | 'up' | 'move', [x, y]: Point, { width, height }: Sheet): void {
  const [right, down] = [x / width, y / height]
  if (pen === 'up') store.announce(text.strokes.penUp)
  else store.announce(pen === 'down' ? text.strokes.penDown(right, down) : text.strokes.penAt(right, down))
}

/** Return what an edit of the strokes did, in words; null where another drawing was opened. */
export function editText(before: History<Strokes>, now: History<Strokes>): string | null {
  if (now.future[0] === before.present) return text.strokes.undone
  if (now.past.at(-1) !== before.present) return null
  if (before.future[0] === now.present) return text.strokes.redone
  if (isEmpty(now.present)) return text.strokes.cleared
  if (before.present.frame !== now.present.frame) return text.clip.frameChosen(now.present.frame ?? 0)
  if (before.present.edits !== now.present.edits) return text.capture.edited
  if (before.present.distance !== now.present.distance && now.present.distance) return text.capture.scaled
  const scaleText = scaleEditText(before.present.scale, now.present.scale)
  if (scaleText) return scaleText
  const [gone] = missing(before.present, now.present)
  const [come, more] = missing(now.present, before.present)
  if (come) return more ? text.sheets.opened : text.strokes.drawn(strokeName(come))
  return gone ? text.strokes.deleted(strokeName(gone)) : null
}

function isSame(one: Selection, other: Selection | null): boolean {
  return JSON.stringify(one) === JSON.stringify(other)
}

/** Return what became of the measured line: another length, or another end; null where it is new, gone or as it was. */
function scaleEditText(before: Scale | null, now: Scale | null): string | null {
  if (!before || !now || before === now) return null
  if (before.points === now.points) return text.strokes.measured(text.metres(now.metres))
  const isMoved = now.points.some(end => before.points.includes(end))
  return isMoved ? text.strokes.moved(text.strokes.scale) : null
}

/** List the strokes that others lack; more than one at once were opened, not drawn. */
function missing(strokes: Strokes, others: Strokes): StrokeRef[] {
  const known = new Set(strokeRefs(others).map(ref => lineOf(others, ref)))
  return strokeRefs(strokes).filter(ref => !known.has(lineOf(strokes, ref)))
}

/** Count the tips of what was traced: each ends one branch. */
function tipCount({ parents }: Pick<TracedSkeleton, 'parents'>): number {
  const bearing = new Set(parents)
  return parents.filter((_, joint) => !bearing.has(joint)).length
}
