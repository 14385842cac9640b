import type { History } from '../history'
import { isEmpty, lineOf, type StrokeRef, type Strokes, strokeRefs } from '../strokes'
import { text } from '../text'
import { strokeName } from './strokeNames'

/** Say what an edit of the strokes did, for those who do not see it; null where another drawing was opened. */
export function editSaid(before: History<Strokes>, now: History<Strokes>): string | null {
  if (now.future[0] === before.present) return text.strokes.undone
  if (now.past.at(-1) !== before.present) return null
  if (before.future[0] === now.present) return text.strokes.redone
  if (isEmpty(now.present)) return text.strokes.cleared
  const { scale } = now.present
  if (scale && before.present.scale?.points === scale.points && before.present.scale !== scale)
    return text.strokes.measured(text.metres(scale.metres))
  const [gone] = missing(before.present, now.present)
  const [come, more] = missing(now.present, before.present)
  if (come) return more ? text.sheets.opened : text.strokes.drawn(strokeName(come))
  return gone ? text.strokes.deleted(strokeName(gone)) : null
}

/** Find the strokes of `strokes` that `others` have not: more than one were not drawn, but opened. */
function missing(strokes: Strokes, others: Strokes): StrokeRef[] {
  const known = new Set(strokeRefs(others).map(ref => lineOf(others, ref)))
  return strokeRefs(strokes).filter(ref => !known.has(lineOf(strokes, ref)))
}
