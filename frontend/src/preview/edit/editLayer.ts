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
/** Branches whose distances from the pointer differ less count as equally near, CSS px. */
const HARDLY = 3
/** The least distance of two points of a branch that is drawn, CSS px. */
const SPACING = 9

/** From where the branches are seen. */
interface Sight {
  readonly pose: Pose
  readonly viewport: Viewport
  readonly world: Similarity
}

/** What the layer asks of what it lies over. */
interface Hooks {
  /** Called when another frame is needed. */
  changed(): void
  /** Move the photo under the branches, CSS px; does nothing where one does not look from a photo. */
  pan(across: number, down: number): void
  /** Ends the layer's listening. */
  readonly signal: AbortSignal
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
  /** Where the pointer is that may move the photo. */
  private held: PointerEvent | null = null

  constructor(
    host: HTMLElement,
    private readonly canvas: HTMLCanvasElement,
    private readonly events: EditEvents,
    private readonly hooks: Hooks,
  ) {
    this.overlay.className = 'preview-branches'
    this.overlay.hidden = true
    host.append(this.overlay)
    // Before the rig's own listeners, which would turn the camera.
    const first = { capture: true, signal: hooks.signal }
    host.addEventListener('pointerdown', event => this.onDown(event), first)
    host.addEventListener('pointermove', event => this.onMove(event), first)
    host.addEventListener('pointerup', event => this.onUp(event), first)
    host.addEventListener('pointercancel', () => this.stop(), first)
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

  private onScreen({ points, radii }: Branches): OnScreen[] {
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
    return nearestOnScreen(this.onScreen(this.editing.branches), this.editing.branches.parents, { at: [x, y], reach })
  }

  private onDown(event: PointerEvent): void {
    const { editing } = this
    if (!editing || event.target !== this.canvas || event.button !== 0 || !event.isPrimary) return
    const joint = this.takenBy(event, editing)
    this.held = joint === null ? event : null
    if (joint === null || editing.tool === 'join') return
    event.stopPropagation()
    event.preventDefault()
    this.canvas.focus({ preventScroll: true })
    this.canvas.setPointerCapture(event.pointerId)
    this.drag = { tool: editing.tool, joint, pointer: event.pointerId, path: [] }
  }

  /** Return the joint that a press drags: with the tool for branches any, else the selected one. */
  private takenBy(event: PointerEvent, { tool, selected }: Editing): number | null {
    const place = this.placeOf(event)
    const reach = event.pointerType === 'touch' ? REACH.touch : REACH.fine
    if (tool === 'add') return this.jointAt(place, reach)
    return tool === 'move' && selected && this.isAt(selected, place, reach) ? selected : null
  }

  private isAt(joint: number, place: readonly [number, number], reach: number): boolean {
    if (!this.sight) return false
    const [x, y] = this.onScreen(this.editing!.branches)[joint] ?? [Number.NaN, 0]
    return Math.hypot(x - place[0], y - place[1]) <= reach
  }

  private onMove(event: PointerEvent): void {
    const { drag, held } = this
    if (held?.pointerId === event.pointerId) {
      this.held = event
      this.hooks.pan(event.clientX - held.clientX, event.clientY - held.clientY)
    }
    if (!drag || event.pointerId !== drag.pointer) return
    event.stopPropagation()
    const place = this.placeOf(event)
    const last = drag.path.at(-1)
    if (drag.tool === 'move') this.drag = { ...drag, path: [place] }
    else if (!last || Math.hypot(last[0] - place[0], last[1] - place[1]) >= SPACING)
      this.drag = { ...drag, path: [...drag.path, place] }
    this.hooks.changed()
  }

  private onUp(event: PointerEvent): void {
    const { drag } = this
    this.held = null
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
    this.held = null
    this.hooks.changed()
  }

  private placeOf({ clientX, clientY }: PointerEvent): readonly [number, number] {
    const { left, top } = this.canvas.getBoundingClientRect()
    return [clientX - left, clientY - top]
  }
}

/** A joint on the screen, CSS px, with its distance from the eye and its radius. */
type OnScreen = readonly [x: number, y: number, depth: number, radius: number]

/** Return the nearer joint of the edge that is nearest to a place; of those hardly farther, that of the one nearest to the eye. */
export function nearestOnScreen(
  joints: readonly OnScreen[],
  parents: readonly number[],
  { at, reach }: { at: readonly [number, number]; reach: number },
): number | null {
  const edges = joints.map((joint, index) => edgeFrom(joints[parents[index]!] ?? joint, joint, at))
  const least = edges.reduce((best, { away }) => Math.min(best, away), Number.POSITIVE_INFINITY)
  if (least > reach) return null
  const near = [...edges.keys()].filter(index => edges[index]!.away <= least + HARDLY)
  const chosen = near.reduce((best, index) => (joints[index]![2] < joints[best]![2] ? index : best))
  return edges[chosen]!.share < 0.5 && parents[chosen]! >= 0 ? parents[chosen]! : chosen
}

/** Return how far the wood of an edge is from a place, px, and the share of its way at which it is nearest. */
function edgeFrom(from: OnScreen, to: OnScreen, [x, y]: readonly [number, number]): { away: number; share: number } {
  if (from[2] <= 0 || to[2] <= 0) return { away: Number.POSITIVE_INFINITY, share: 1 }
  const [across, down] = [to[0] - from[0], to[1] - from[1]]
  const square = across ** 2 + down ** 2
  const share = square ? Math.min(Math.max(((x - from[0]) * across + (y - from[1]) * down) / square, 0), 1) : 1
  const away = Math.hypot(from[0] + share * across - x, from[1] + share * down - y) - to[3]
  return { away: Math.max(away, 0), share }
}
