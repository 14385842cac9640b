import { type Branches, moved } from '../../branches'
import { type Pose, projected, unprojected, type Vec3, type Viewport } from '../camera'
import { inverse, moved as placed, type Similarity } from '../capture/similarity'
import { drawBranches } from './drawBranches'

/** What a drag from a joint does: it moves the one that is selected, or draws a branch; `join` takes clicks only. */
export type EditTool = 'move' | 'add' | 'join'

/** The branches that are edited, and how. */
export interface Editing {
  readonly tool: EditTool
  readonly branches: Branches
  readonly selected: number | null
}

/** Called as the pointer edits; places are in the capture's frame. */
export interface EditEvents {
  picked(joint: number | null): void
  moved(joint: number, to: Vec3): void
  drew(from: number, points: readonly Vec3[]): void
}

/** How far from a joint the pointer may be to take it, CSS px. */
const REACH = { fine: 12, touch: 22 }
/** The least distance of two points of a branch that is drawn, CSS px. */
const SPACING = 9

/** From where the branches are seen. */
interface Sight {
  readonly pose: Pose
  readonly viewport: Viewport
  readonly world: Similarity
}

/** What is being dragged: a joint, or a branch that is drawn from one; its points are places on the screen. */
interface Drag {
  readonly tool: 'move' | 'add'
  readonly joint: number
  readonly pointer: number
  readonly path: readonly (readonly [number, number])[]
}

/** Branches over the tree and over the photo, with what the pointer does to them. */
export class EditLayer {
  private readonly overlay = document.createElement('canvas')
  private editing: Editing | null = null
  private sight: Sight | null = null
  private drag: Drag | null = null

  /** `changed` is called when another frame is needed. */
  constructor(
    host: HTMLElement,
    private readonly canvas: HTMLCanvasElement,
    private readonly events: EditEvents,
    private readonly changed: () => void,
  ) {
    this.overlay.className = 'preview-branches'
    this.overlay.hidden = true
    host.append(this.overlay)
    // Before the rig's own listeners, which would turn the camera.
    host.addEventListener('pointerdown', event => this.onDown(event), { capture: true })
    host.addEventListener('pointermove', event => this.onMove(event), { capture: true })
    host.addEventListener('pointerup', event => this.onUp(event), { capture: true })
    host.addEventListener('pointercancel', () => this.stop(), { capture: true })
  }

  get isOn(): boolean {
    return this.editing !== null
  }

  /** Edit branches; null ends it. */
  set(editing: Editing | null): void {
    if (this.drag && editing?.branches !== this.editing?.branches) this.drag = null
    this.editing = editing
    this.overlay.hidden = editing === null
  }

  /** Draw the branches as they are seen from a pose. */
  draw(pose: Pose, viewport: Viewport, world: Similarity): void {
    this.sight = { pose, viewport, world }
    const { editing } = this
    if (!editing) return
    const ratio = Math.min(devicePixelRatio, 2)
    const [width, height] = [Math.round(viewport.width * ratio), Math.round(viewport.height * ratio)]
    if (this.overlay.width !== width || this.overlay.height !== height) Object.assign(this.overlay, { width, height })
    const ctx = this.overlay.getContext('2d')!
    ctx.setTransform(ratio, 0, 0, ratio, 0, 0)
    ctx.clearRect(0, 0, viewport.width, viewport.height)
    const branches = this.shown(editing)
    const selected = this.drag?.joint ?? editing.selected
    const line = this.drag?.tool === 'add' ? this.drag.path : []
    drawBranches(ctx, { ...branches, points: this.onScreen(branches) }, { selected, line })
  }

  /** Select what is at a place that was clicked on, CSS px. */
  click(place: readonly [number, number]): void {
    const joint = this.jointAt(place, REACH.fine)
    if (this.editing?.tool === 'join' && joint === null) return
    this.events.picked(joint)
  }

  /** Return the branches, with the joint that is dragged where the pointer has it. */
  private shown({ branches }: Editing): Branches {
    const to = this.drag?.tool === 'move' ? this.spotAt(this.drag.path.at(-1), this.drag.joint) : null
    return to ? moved(branches, this.drag!.joint, to) : branches
  }

  private onScreen({ points, radii }: Branches): [x: number, y: number, depth: number, radius: number][] {
    const { pose, viewport, world } = this.sight!
    const perUnit = (viewport.height / 2 / pose.slope) * Math.hypot(world[0][0], world[0][1], world[0][2])
    return points.map((point, joint) => {
      const [x, y, depth] = projected(pose, placed(world, point), viewport)
      return [x, y, depth, (radii[joint]! * perUnit) / depth]
    })
  }

  /** Return the place in the capture's frame that is seen at a place on the screen, as far away as a joint. */
  private spotAt(place: readonly [number, number] | undefined, joint: number): Vec3 | null {
    const point = this.editing?.branches.points[joint]
    if (!place || !point || !this.sight) return null
    const { pose, viewport, world } = this.sight
    const depth = projected(pose, placed(world, point), viewport)[2]
    return placed(inverse(world), unprojected(pose, place, depth, viewport))
  }

  private jointAt([x, y]: readonly [number, number], reach: number): number | null {
    if (!this.editing || !this.sight) return null
    return nearestOnScreen(this.onScreen(this.editing.branches), [x, y], reach)
  }

  private onDown(event: PointerEvent): void {
    const { editing } = this
    if (!editing || editing.tool === 'join' || event.target !== this.canvas || event.button !== 0) return
    const place = this.placeOf(event)
    const joint = this.jointAt(place, event.pointerType === 'touch' ? REACH.touch : REACH.fine)
    const taken = editing.tool === 'add' ? joint !== null : joint !== null && this.isKnob(place, event)
    if (!taken || !event.isPrimary) return
    event.stopPropagation()
    event.preventDefault()
    this.canvas.focus({ preventScroll: true })
    this.canvas.setPointerCapture(event.pointerId)
    const { tool } = editing
    this.drag = { tool, joint: tool === 'move' ? editing.selected! : joint!, pointer: event.pointerId, path: [] }
  }

  /** Whether the pointer is on the selected joint; the root stays where the trunk's stroke begins. */
  private isKnob(place: readonly [number, number], { pointerType }: PointerEvent): boolean {
    const { branches, selected } = this.editing!
    if (!selected || !this.sight) return false
    const [x, y] = this.onScreen(branches)[selected]!
    return Math.hypot(x - place[0], y - place[1]) <= (pointerType === 'touch' ? REACH.touch : REACH.fine)
  }

  private onMove(event: PointerEvent): void {
    const { drag } = this
    if (!drag || event.pointerId !== drag.pointer) return
    event.stopPropagation()
    const place = this.placeOf(event)
    const last = drag.path.at(-1)
    if (drag.tool === 'move') this.drag = { ...drag, path: [place] }
    else if (!last || Math.hypot(last[0] - place[0], last[1] - place[1]) >= SPACING)
      this.drag = { ...drag, path: [...drag.path, place] }
    this.changed()
  }

  private onUp(event: PointerEvent): void {
    const { drag } = this
    if (!drag || event.pointerId !== drag.pointer) return
    event.stopPropagation()
    const spots = drag.path.map(place => this.spotAt(place, drag.joint)).filter(spot => spot !== null)
    this.stop()
    const last = spots.at(-1)
    if (!last) this.events.picked(drag.joint)
    else if (drag.tool === 'move') this.events.moved(drag.joint, last)
    else this.events.drew(drag.joint, spots)
  }

  private stop(): void {
    this.drag = null
    this.changed()
  }

  private placeOf({ clientX, clientY }: PointerEvent): readonly [number, number] {
    const { left, top } = this.canvas.getBoundingClientRect()
    return [clientX - left, clientY - top]
  }
}

/** Return the joint nearest to a place within reach; of those that are hardly farther, the one nearest to the eye. */
export function nearestOnScreen(
  joints: readonly (readonly [x: number, y: number, depth: number, radius: number])[],
  [x, y]: readonly [number, number],
  reach: number,
): number | null {
  const away = joints.map(joint => (joint[2] > 0 ? Math.hypot(joint[0] - x, joint[1] - y) : Number.POSITIVE_INFINITY))
  const least = away.reduce((one, other) => Math.min(one, other), Number.POSITIVE_INFINITY)
  if (least > reach) return null
  const near = [...away.keys()].filter(joint => away[joint]! <= least + 3)
  return near.reduce((best, joint) => (joints[joint]![2] < joints[best]![2] ? joint : best))
}
