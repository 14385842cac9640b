import { lookingOnly } from '../../access'
import { isFinished } from '../../api/follow'
import type { Sheets, ShownModel, State } from '../../state'
import type { Strokes } from '../../strokes'
import { hasTrunk } from '../../studio/inputs'
import { isOfFile, sameValue } from './settingGroups'

/** Where growing stands, as the page says it. */
export type GrowthStatus =
  | 'looking'
  | 'noPhoto'
  | 'noCrown'
  | 'noTrunk'
  | 'noFront'
  | 'noCameras'
  | 'noClip'
  | 'badStroke'
  | 'ready'
  | 'asking'
  | 'queued'
  | 'growing'
  | 'loading'
  | 'grown'
  | 'strokesChanged'
  | 'settingsChanged'
  | 'filesChanged'
  | 'failed'
  | 'canceled'

const BUSY: readonly GrowthStatus[] = ['asking', 'queued', 'growing']
/** A tree is shown, or about to be. */
const SHOWN: readonly GrowthStatus[] = ['loading', 'grown']
const INCOMPLETE: readonly GrowthStatus[] = [
  'looking',
  'noPhoto',
  'noCrown',
  'noTrunk',
  'noFront',
  'noCameras',
  'noClip',
  'badStroke',
]

/** Return where growing stands. */
export function growthStatusOf(state: State): GrowthStatus {
  const status = statusOf(state)
  return lookingOnly(state.session) && canGrow(status) && !SHOWN.includes(status) ? 'looking' : status
}

function statusOf(state: State): GrowthStatus {
  const { asking, model, sheets, faults } = state
  if (asking) return 'asking'
  if (model && !isFinished(model.info)) return model.info.status === 'queued' ? 'queued' : 'growing'
  if (!sheets) return 'noPhoto'
  const lack = lackOf(sheets, state.history.present)
  if (lack) return lack
  if (faults.strokes?.stroke) return 'badStroke'
  return model ? statusOfEnded(state, model) : 'ready'
}

/** Return what a tree cannot be grown without; null where all of it is there. */
function lackOf(sheets: Sheets, strokes: Strokes): GrowthStatus | null {
  const { crown, views = [] } = strokes
  if (sheets.source === 'sketch') return hasTrunk(strokes) ? null : 'noFront'
  if (!crown && !views.some(view => view.crown)) return 'noCrown'
  if (sheets.source === 'clip') return sheets.clip.id === null ? 'noClip' : null
  if (!hasTrunk(strokes)) return 'noTrunk'
  return sheets.source === 'capture' && !sheets.capture.cameras.length ? 'noCameras' : null
}

/** Whether a tree is being made, so that no other can be asked for. */
export function isBusy(status: GrowthStatus): boolean {
  return BUSY.includes(status)
}

/** Whether Grow would do something. */
export function canGrow(status: GrowthStatus): boolean {
  return !isBusy(status) && !INCOMPLETE.includes(status)
}

function statusOfEnded(state: State, model: ShownModel): GrowthStatus {
  const { info, strokes, glb } = model
  const sameStrokes = strokes === state.history.present
  if (info.status !== 'succeeded') return sameStrokes ? (info.status as 'failed' | 'canceled') : 'ready'
  if (!glb && !state.faults.grow) return 'loading'
  return sameStrokes ? statusOfSettings(state, model) : 'strokesChanged'
}

/** Compare what is chosen now with what the model was made with. */
function statusOfSettings({ limits, seed, leaf, fruit, ...state }: State, model: ShownModel): GrowthStatus {
  const { settings, seed: grownSeed } = model.info
  const chosen: Readonly<Record<string, unknown>> = state.settings
  const changed = Object.keys(chosen).filter(name => !sameValue(chosen[name], settings[name] ?? chosen[name]))
  if (seed !== grownSeed || leaf !== model.leaf || fruit !== model.fruit) return 'settingsChanged'
  if (!changed.length) return 'grown'
  return changed.every(name => isOfFile(limits, name)) ? 'filesChanged' : 'settingsChanged'
}
