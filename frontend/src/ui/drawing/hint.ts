import { lookingOnly } from '../../access'
import { isFinished, isSolving } from '../../api/follow'
import { doubtIn, remarksOn, type StrokeRemark } from '../../doubts'
import { captureOf, clipOf, drawnOn, isPaper, photoDrawnOn } from '../../sheets'
import type { PointerKind } from '../../sketch/gesture'
import type { State } from '../../state'
import { lineOf, type StrokeRef } from '../../strokes'
import { hasTrunk } from '../../studio/inputs'
import { text } from '../../text'
import { remarkText, strokeName } from './strokeTexts'

/** The next step, or what stands in its way. */
export interface Hint {
  readonly tone: 'step' | 'note' | 'fault'
  readonly text: string
  /** How to do it with the pointer in use. */
  readonly how?: string
  /** The stroke at fault, which can be deleted. */
  readonly stroke?: StrokeRef
  /** Set where a selection can be deleted. */
  readonly deletes?: true
}

/** Return the next step and how to do it with the pointer in use, or what is wrong. */
export function hintOf(state: State, pointer: PointerKind): Hint {
  const fault = state.faults.strokes
  if (fault) return { tone: 'fault', text: fault.text, ...(fault.stroke && { stroke: fault.stroke }) }
  if (!state.online) return { tone: 'note', text: text.hints.offline }
  const next = step(state, pointer)
  const note = noteOf(state)
  return note && !next.deletes ? { tone: 'note', text: note, how: next.text } : next
}

/** Return what was corrected in the drawing or its last stroke, or what is in doubt. */
function noteOf(state: State): string | null {
  const { corrections, history } = state
  if (corrections?.of === history.present) return corrections.text
  const said = doubtIn(state) ?? newRemark(state)
  return said ? remarkText(said) : null
}

/** Find a remark on the stroke that was drawn last; older remarks have been shown. */
function newRemark(state: State): StrokeRemark | undefined {
  const { present, past } = state.history
  const before = past.at(-1)
  return before && remarksOn(state).find(({ stroke }) => stroke && lineOf(present, stroke) !== lineOf(before, stroke))
}

function step(state: State, pointer: PointerKind): Hint {
  const { tool, selection } = state
  const { crown, branches } = drawnOn(state, 'front')
  const how = text.hints.how[pointer]
  if (selection?.kind === 'scale') return stepTo(text.hints.measured)
  if (selection) return { tone: 'step', text: text.hints.selected(strokeName(selection)), deletes: true }
  if (tool === 'scale') return stepTo(text.hints.measure, text.hints.measureNear)
  if (isPaper(state, state.active)) return sketchStep(state, pointer) ?? laterStep(state, pointer)
  if (hasTrunk(state.history.present) && captureOf(state)) return captureStep(state, pointer)
  if (clipOf(state)) return clipStep(state, pointer)
  if (!crown) return tool === 'crown' ? stepTo(text.hints.crown, how.crown) : stepTo(text.hints.chooseCrown)
  if (!branches.length)
    return tool === 'branch' ? stepTo(text.hints.trunk, how.branch) : stepTo(text.hints.chooseBranch)
  return laterStep(state, pointer)
}

/** Return the next step once one of many photos has its crown and its trunk. */
function captureStep(state: State, pointer: PointerKind): Hint {
  const { hints } = text.capture
  const capture = captureOf(state)!
  const { crown, branches, erase } = drawnOn(state, 'front')
  const photo = capture.photos.find(({ name }) => name === photoDrawnOn(state))
  if (!crown && branches.length + erase.length > 0) return stepTo(hints.crownMissing)
  if (photo?.used === false) return stepTo(hints.notUsed)
  if (!capture.cameras.length) return stepTo(state.sending || isSolving(state.solve) ? hints.waiting : hints.unsolved)
  if (!state.traced) return stepTo(hints.reading)
  const later = laterStep(state, pointer)
  return later.text === text.hints.refine ? stepTo(hints.refine) : later
}

/** Return the next step over a frame of a clip: its outline is enough, and a trunk is welcome. */
function clipStep(state: State, pointer: PointerKind): Hint {
  const { hints } = text.clip
  const how = text.hints.how[pointer]
  const { crown, branches } = drawnOn(state, 'front')
  if (!crown) return state.tool === 'crown' ? stepTo(hints.crown, how.crown) : stepTo(text.hints.chooseCrown)
  if (state.model || branches.length) return laterStep(state, pointer)
  return state.traced ? stepTo(hints.trunk, how.branch) : stepTo(hints.reading)
}

/** Return the next step on paper; null once trunk and branches are drawn. */
function sketchStep(state: State, pointer: PointerKind): Hint | null {
  const { hints } = text.sheets
  const { branches, side } = state.history.present
  const onSide = state.active === 'side'
  if (state.tool !== 'branch' && !(onSide ? side : state.history.present)?.branches.length)
    return stepTo(hints.chooseBranch)
  if (onSide) return sideStep(state, hints.how[pointer])
  if (!branches.length) return stepTo(hints.trunk, hints.how[pointer])
  const lacksSide = branches.length > 1 && !side?.branches.length && !state.model
  return lacksSide ? stepTo(hints.side, hints.sideHow) : null
}

function sideStep({ sheets, history }: State, how: string): Hint | null {
  const { hints } = text.sheets
  const count = history.present.side?.branches.length ?? 0
  if (count === 0) return stepTo(sheets?.source === 'photo' ? hints.mixed : hints.sideTrunk, how)
  if (count === 1) return stepTo(hints.branches, how)
  return sheets?.source === 'photo' ? stepTo(hints.mixedGrow) : null
}

function laterStep(state: State, pointer: PointerKind): Hint {
  const { tool, history, liveTree, model, sheets, session } = state
  if (tool === 'select') return stepTo(text.hints.select, text.hints.how[pointer].select)
  if (model && !isFinished(model.info)) return stepTo(text.hints.growing)
  if (model?.info.status === 'succeeded' && model.strokes === history.present)
    return stepTo(lookingOnly(session) ? text.hints.shown : text.hints.done)
  if (!liveTree) return stepTo(text.hints.waiting)
  return stepTo(sheets?.source === 'sketch' ? text.sheets.hints.refine : text.hints.refine)
}

function stepTo(sentence: string, how?: string): Hint {
  return { tone: 'step', text: sentence, ...(how && { how }) }
}
