import { useLayoutEffect } from 'preact/hooks'
import type { Step } from '../../branches'
import { scaleOf } from '../../preview/capture/similarity'
import { captureOf } from '../../sheets'
import type { BranchTool, State } from '../../state'
import { editable, isAhead, selectedJoint } from '../../studio/edits'
import { text } from '../../text'
import { tracedInSpace } from '../../tracedOn'
import { IconButton } from '../parts/IconButton'
import { ICONS } from '../parts/icons'
import { useStore, useStudio } from '../parts/useStore'
import './editTools.css'
import { treeFrom } from './followMeasured'

const { edits: words } = text.measured
const TOOLS: readonly BranchTool[] = ['move', 'add', 'join']
const STEPS: readonly (readonly [Step, (typeof ICONS)[keyof typeof ICONS]])[] = [
  ['inward', ICONS.down],
  ['outward', ICONS.up],
  ['across', ICONS.across],
]
/** Centimetres of thickness in a metre of radius. */
const CM = 200

/** The tools that edit the branches of many photos, over the tree; hidden while they are not edited. */
export function EditTools() {
  const { edits } = useStudio()
  const tool = useStore(state => (canEdit(state) ? state.branchTool : null))
  useEscape(tool !== null)
  return (
    <div class="overlay edit-tools" role="group" aria-label={words.title} hidden={tool === null}>
      <div class="edit-row">
        {TOOLS.map(name => (
          <button
            type="button"
            class="button"
            key={name}
            aria-pressed={tool === name}
            onClick={() => edits.choose(name)}
          >
            {words.tools[name]}
          </button>
        ))}
        <History />
        <button type="button" class="button primary" onClick={() => edits.choose(null)}>
          {words.end}
        </button>
      </div>
      <p class="edit-hint">{useStore(hintOf)}</p>
      <SelectedBranch />
      <LostEdits />
    </div>
  )
}

/** Let Escape deselect what is selected, and where nothing is, end the editing. */
function useEscape(isOn: boolean): void {
  const { edits, store } = useStudio()
  useLayoutEffect(() => {
    const press = (event: KeyboardEvent) => {
      if (!isOn || event.key !== 'Escape' || event.defaultPrevented || document.querySelector('dialog[open]')) return
      if (selectedJoint(store.state) === null) edits.choose(null)
      else edits.picked(null)
    }
    addEventListener('keydown', press)
    return () => removeEventListener('keydown', press)
  }, [isOn])
}

/** Whether there are branches that can be edited. */
export function canEdit(state: State): boolean {
  return captureOf(state) !== null && tracedInSpace(state) !== null
}

function History() {
  const { strokes } = useStudio()
  const past = useStore(({ history }) => history.past.length > 0)
  const future = useStore(({ history }) => history.future.length > 0)
  return (
    <>
      <IconButton label={words.undo} icon={ICONS.undo} disabled={!past} onClick={() => strokes.undo()} />
      <IconButton label={words.redo} icon={ICONS.redo} disabled={!future} onClick={() => strokes.redo()} />
    </>
  )
}

function hintOf(state: State): string {
  const { branchTool } = state
  if (isAhead(state)) return words.hints.waiting
  if (branchTool === 'add') return words.hints.add
  const isSelected = selectedJoint(state) !== null
  if (branchTool === 'join') return isSelected ? words.hints.join : words.hints.joinPick
  return isSelected ? words.hints.move : words.hints.pick
}

/** What can be done with the branch from the selected joint on; the arrows reach every joint by keyboard. */
function SelectedBranch() {
  const { edits, store } = useStudio()
  const joint = useStore(selectedJoint)
  const thickness = useStore(thicknessOf)
  useLayoutEffect(() => {
    if (thickness !== null && store.state.branchTool) store.announce(words.selected(thickness))
  }, [joint, thickness])
  return (
    <div class="edit-row">
      {STEPS.map(([step, icon]) => (
        <IconButton key={step} label={words.step[step]} icon={icon} onClick={() => edits.step(step)} />
      ))}
      <ThicknessField thickness={thickness} />
      <IconButton label={words.removeWhy} icon={ICONS.remove} disabled={!joint} onClick={() => edits.remove()} />
    </div>
  )
}

/** How thick the branch is at the selected joint, in centimetres. */
function ThicknessField({ thickness }: { readonly thickness: string | null }) {
  const { edits, store } = useStudio()
  const set = (written: string) => {
    const [cm, scale] = [Number(written), metresIn(store.state)]
    if (cm > 0 && Number.isFinite(cm) && written !== thickness) edits.setRadius(cm / CM / scale)
  }
  return (
    <label class="edit-thickness">
      <span>{words.thickness}</span>
      <input
        type="number"
        min="0.1"
        step="0.1"
        inputMode="decimal"
        disabled={thickness === null}
        value={thickness ?? ''}
        onChange={event => set(event.currentTarget.value)}
      />
      <span>{words.unit}</span>
    </label>
  )
}

/** Return the thickness at the selected joint as it can be typed, cm; null where none is selected. */
function thicknessOf(state: State): string | null {
  const radius = editable(state)?.radii[selectedJoint(state) ?? -1]
  return radius === undefined ? null : (radius * metresIn(state) * CM).toFixed(1)
}

/** Return the metres of a length of one in the capture's frame. */
function metresIn(state: State): number {
  const answer = tracedInSpace(state)
  return answer ? scaleOf(treeFrom(answer)) : 1
}

/** A sentence about the edits that the service could not apply, with its reason for the first. */
function LostEdits() {
  const lost = useStore(lostText)
  return (
    <p class="edit-lost" role="status" hidden={!lost}>
      {lost}
    </p>
  )
}

function lostText(state: State): string {
  const lost = (tracedInSpace(state)?.warnings ?? []).filter(({ code }) => code === 'edit_lost')
  const [first] = lost
  return first ? words.lost(lost.length, reasonOf(first.detail)) : ''
}

/** Return the reason alone: the service's sentence begins with what happened. */
function reasonOf(detail: string): string {
  return detail.replace(/^[^:]*: /, '')
}
