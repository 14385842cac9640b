import { type Branches, nearestJoint, type Step, stepped } from '../branches'
import type { Edit, Spot } from '../edits'
import type { BranchTool, State, Store } from '../state'
import { tracedInSpace } from '../tracedOn'
import type { StrokeActions } from './strokeActions'

/** Edits the branches that many photos show; each edit can be undone, as strokes can. */
export class BranchEdits {
  /** Where the last edit was: the joint that is there in the service's answer is selected again. */
  #lastAt: Spot | null = null

  constructor(
    private readonly store: Store,
    private readonly strokes: Pick<StrokeActions, 'edit' | 'remove' | 'select'>,
  ) {
    store.watch(
      state => state.traced,
      () => this.#selectAgain(),
    )
  }

  /** Choose what the pointer does to branches where the tree is shown; null ends editing them. */
  choose(branchTool: BranchTool | null): void {
    this.store.set({ branchTool })
    if (!branchTool) this.strokes.select(null)
  }

  /** Select a joint that was clicked on; where a piece is to be joined, hang the selected piece onto it. */
  picked(joint: number | null): void {
    const { branchTool } = this.store.state
    const selected = selectedJoint(this.store.state)
    const joins = branchTool === 'join' && selected !== null && joint !== null && joint !== selected
    if (joins) this.#join(selected, joint)
    else this.#select(joint)
  }

  /** Select the joint one step from the selected one. */
  step(step: Step): void {
    const branches = editable(this.store.state)
    if (branches) this.#select(stepped(branches, selectedJoint(this.store.state), step))
  }

  /** Move a joint. */
  moved(joint: number, to: Spot): void {
    const at = this.#spot(joint)
    if (at) this.#edit({ do: 'move', at, to }, to)
  }

  /** Add a branch that leaves a joint. */
  drew(joint: number, points: readonly Spot[]): void {
    const from = this.#spot(joint)
    const tip = points.at(-1)
    if (from && tip) this.#edit({ do: 'add', from, points }, tip)
  }

  /** Give the selected joint a radius, in the capture's unit. */
  setRadius(radius: number): void {
    const at = this.#spot(selectedJoint(this.store.state) ?? -1)
    if (at && radius > 0) this.#edit({ do: 'radius', at, radius }, at)
  }

  /** Remove the branch from the selected joint on. */
  remove(): void {
    const { traced } = this.store.state
    const joint = selectedJoint(this.store.state)
    const branches = editable(this.store.state)
    if (!traced || !branches || joint === null) return
    this.#lastAt = branches.points[branches.parents[joint]!] ?? null
    this.strokes.remove()
  }

  #join(piece: number, onto: number): void {
    const [at, to] = [this.#spot(piece), this.#spot(onto)]
    if (at && to) this.#edit({ do: 'join', at, to }, at)
    this.store.set({ branchTool: 'move' })
  }

  #edit(edit: Edit, at: Spot): void {
    this.#lastAt = at
    this.strokes.edit(edit)
  }

  #spot(joint: number): Spot | undefined {
    return editable(this.store.state)?.points[joint]
  }

  #select(joint: number | null): void {
    this.strokes.select(joint === null || !editable(this.store.state) ? null : { kind: 'traced', joint })
  }

  #selectAgain(): void {
    const branches = editable(this.store.state)
    if (!this.#lastAt || !branches || !this.store.state.branchTool) return
    const joint = nearestJoint(branches, this.#lastAt)
    this.#lastAt = null
    if (joint > 0 && !this.store.state.selection) this.#select(joint)
  }
}

/** Return the joint of many photos' branches that is selected; null where none is. */
export function selectedJoint({ selection }: Pick<State, 'selection'>): number | null {
  return selection?.kind === 'traced' ? selection.joint : null
}

/** Return the branches that can be edited: none while the service has not answered the last edit. */
export function editable(state: Pick<State, 'traced' | 'history'>): Branches | null {
  const answer = tracedInSpace(state)
  return answer && !isAhead(state) ? answer.skeleton : null
}

/** Whether there are edits, or some were undone, that the service has not answered. */
export function isAhead({ traced, history }: Pick<State, 'traced' | 'history'>): boolean {
  return traced !== null && traced.of.edits !== history.present.edits
}
