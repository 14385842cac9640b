import type { StrokeRemark } from '../../doubts'
import type { Selection } from '../../state'
import { text } from '../../text'

/** Return the name of a stroke; the first branch is the trunk. */
export function strokeName(selection: Selection): string {
  if ('photo' in selection && selection.photo !== undefined) {
    const { kind, index, photo } = selection
    return text.capture.on(strokeName({ kind, index }), photo)
  }
  if ('sheet' in selection) return text.sheets.on(strokeName({ kind: selection.kind, index: selection.index }))
  const { kind } = selection
  if (kind === 'crown') return text.strokes.crown
  if (kind === 'scale') return text.strokes.scale
  if (kind === 'traced') return text.strokes.traced
  if (kind === 'erase') return text.strokes.erase(selection.index + 1)
  return selection.index === 0 ? text.strokes.trunk : text.strokes.branch(selection.index + 1)
}

/** Return a remark of the service as a sentence of the page. */
export function remarkText({ warning: { code, stroke: place, detail }, stroke }: StrokeRemark): string {
  const words: Readonly<Record<string, string | ((stroke: string) => string)>> = {
    ...text.hints.warnings,
    ...text.hints.doubts,
  }
  const [known, name] = [words[code], stroke ? strokeName(stroke) : place]
  if (typeof known === 'string') return known
  return known ? known(name) : `${name}: ${detail}`
}
