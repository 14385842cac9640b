import { distance } from '../plane'
import type { Tool } from '../state'
import type { Line, Point } from '../strokes'

export type PointerKind = 'mouse' | 'pen' | 'touch'
export type DrawnKind = 'crown' | 'branch' | 'scale'

export interface Down {
  readonly type: 'down'
  readonly id: number
  readonly pointer: PointerKind
  readonly button: number
  /** A point of the window, CSS px, as all points here. */
  readonly at: Point
  /** The longer side of the area that touches the screen, CSS px. */
  readonly contact: number
  readonly tool: Tool
  /** Whether no other pointer of its kind is down. */
  readonly alone: boolean
}

export interface Move {
  readonly type: 'move'
  readonly id: number
  readonly pointer: PointerKind
  readonly at: Point
  /** All points since the last event; the last one is `at`. */
  readonly path: Line
  readonly contact: number
  /** Whether any button or the pen's tip is down. */
  readonly pressed: boolean
}

/** What happens to the pointers and keys. */
export type GestureEvent =
  | Down
  | Move
  | { readonly type: 'up'; readonly id: number; readonly at: Point }
  | { readonly type: 'cancel'; readonly id: number }
  | { readonly type: 'space'; readonly held: boolean }
  | { readonly type: 'escape' }

/** What a gesture asks the sketch to do. */
export type Intent =
  | { readonly type: 'begin'; readonly kind: DrawnKind; readonly at: Point }
  | { readonly type: 'extend'; readonly path: Line }
  | { readonly type: 'end' }
  | { readonly type: 'drop' }
  | { readonly type: 'pan'; readonly by: Point }
  | { readonly type: 'pinch'; readonly factor: number; readonly about: Point; readonly by: Point }
  | { readonly type: 'click'; readonly at: Point; readonly pointer: PointerKind }

interface Press {
  readonly id: number
  readonly pointer: PointerKind
  readonly from: Point
  /** Whether it is a click if the pointer hardly moves. */
  readonly mayClick: boolean
  /** Whether the pointer has moved further than a click allows. */
  readonly moved: boolean
}

interface Drawing extends Press {
  readonly name: 'draw'
  readonly kind: DrawnKind
}

interface Panning extends Press {
  readonly name: 'pan'
  readonly at: Point
}

type Mode =
  | { readonly name: 'idle' }
  | Drawing
  | Panning
  /** Fingers move and scale the sheet until the last one is up. */
  | { readonly name: 'pinch' }
  /** Nothing happens until the last finger is up. */
  | { readonly name: 'ignored' }

export interface Gesture {
  readonly mode: Mode
  readonly touches: ReadonlyMap<number, Point>
  /** Whether a pen was used: from then on fingers never draw. */
  readonly penSeen: boolean
  /** Whether the space bar is held. */
  readonly space: boolean
}

export interface Step {
  readonly state: Gesture
  readonly intents: readonly Intent[]
}

/** A press that moves less far is a click, CSS px. */
const CLICK_DISTANCE = 6
/** A longer contact is a palm, CSS px. */
const PALM_SIZE = 50
const LEFT = 0
const MIDDLE = 1
/** Also the pen's barrel button. */
const RIGHT = 2
const IDLE: Mode = { name: 'idle' }

export const AT_REST: Gesture = { mode: IDLE, touches: new Map(), penSeen: false, space: false }

/** Return the state after an event, and what it asks for. */
export function interpret(state: Gesture, event: GestureEvent): Step {
  if (event.type === 'down') return pressDown(state, event)
  if (event.type === 'move') return move(state, event)
  if (event.type === 'up') return lift(state, event)
  if (event.type === 'cancel') return cancel(state, event.id)
  if (event.type === 'space') return { state: { ...state, space: event.held }, intents: [] }
  return { state: endGesture(state), intents: dropStroke(state.mode) }
}

function pressDown(state: Gesture, event: Down): Step {
  const palm = event.pointer === 'touch' && event.contact > PALM_SIZE
  if (palm || ![LEFT, MIDDLE, RIGHT].includes(event.button)) return { state, intents: [] }
  if (event.pointer === 'touch') return touchDown(state, event)
  return beginPress({ ...state, penSeen: state.penSeen || event.pointer === 'pen' }, event)
}

function touchDown(state: Gesture, event: Down): Step {
  // A finger whose end was missed would otherwise count for ever.
  const touches = new Map(event.alone ? [] : state.touches).set(event.id, event.at)
  const now = { ...state, touches }
  if (isPress(state.mode) && state.mode.pointer !== 'touch') return { state: now, intents: [] }
  if (touches.size === 1) return beginPress(now, event)
  if (state.mode.name === 'ignored') return { state: now, intents: [] }
  return { state: { ...now, mode: { name: 'pinch' } }, intents: dropStroke(state.mode) }
}

function beginPress(state: Gesture, event: Down): Step {
  const { id, pointer, at, button, tool } = event
  const press = { id, pointer, from: at, moved: false }
  const before = dropStroke(state.mode)
  const kind = kindDrawn(state, event)
  if (kind === null) {
    const mayClick = button === LEFT && !state.space
    return { state: { ...state, mode: { ...press, name: 'pan', at, mayClick } }, intents: before }
  }
  const mayClick = button === LEFT && kind === tool
  return {
    state: { ...state, mode: { ...press, name: 'draw', kind, mayClick } },
    intents: [...before, { type: 'begin', kind, at }],
  }
}

/** Return what a press draws; null where it moves the sheet. */
function kindDrawn({ space, penSeen }: Gesture, { button, pointer, tool }: Down): DrawnKind | null {
  if (button === MIDDLE || (button === LEFT && space) || (pointer === 'touch' && penSeen)) return null
  if (button === RIGHT) return 'branch'
  return tool === 'select' ? null : tool
}

function move(state: Gesture, event: Move): Step {
  const { id, at, pointer } = event
  const before = state.touches
  const touches = before.has(id) ? new Map(before).set(id, at) : before
  const now = { ...state, touches, penSeen: state.penSeen || pointer === 'pen' }
  if (pointer === 'touch' && event.contact > PALM_SIZE) return cancel(state, id)
  const { mode } = state
  if (mode.name === 'pinch') return { state: now, intents: pinch(before, touches) }
  if (!isPress(mode) || mode.id !== id) return { state: now, intents: [] }
  if (!event.pressed) return lift(now, { id, at })
  return mode.name === 'draw' ? extendStroke(now, mode, event) : pan(now, mode, event)
}

function extendStroke(state: Gesture, mode: Drawing, { path }: Move): Step {
  const moved = mode.moved || path.some(point => distance(mode.from, point) >= CLICK_DISTANCE)
  return { state: { ...state, mode: { ...mode, moved } }, intents: [{ type: 'extend', path }] }
}

function pan(state: Gesture, mode: Panning, { at }: Move): Step {
  const moved = mode.moved || !mode.mayClick || distance(mode.from, at) >= CLICK_DISTANCE
  if (!moved) return { state, intents: [] }
  return { state: { ...state, mode: { ...mode, moved, at } }, intents: [{ type: 'pan', by: offset(mode.at, at) }] }
}

/** Return how the first two fingers, or the one that is left, move and scale the sheet. */
function pinch(before: ReadonlyMap<number, Point>, after: ReadonlyMap<number, Point>): Intent[] {
  const [a, b] = [...before.values()]
  const [c, d] = [...after.values()]
  if (!a || !c || before === after) return []
  if (!b || !d) return [{ type: 'pan', by: offset(a, c) }]
  const about = midpoint(c, d)
  const factor = Math.max(distance(c, d), 1) / Math.max(distance(a, b), 1)
  return [{ type: 'pinch', factor, about, by: offset(midpoint(a, b), about) }]
}

function lift(state: Gesture, { id, at }: { readonly id: number; readonly at: Point }): Step {
  const { mode } = state
  const now = removeTouch(state, id)
  if (!isPress(mode) || mode.id !== id) return { state: now, intents: [] }
  const click: Intent[] = mode.mayClick && !mode.moved ? [{ type: 'click', at, pointer: mode.pointer }] : []
  if (mode.name === 'pan') return { state: endGesture(now), intents: click }
  const end: Intent[] = mode.moved ? [{ type: 'extend', path: [at] }, { type: 'end' }] : [{ type: 'drop' }, ...click]
  return { state: endGesture(now), intents: end }
}

function cancel(state: Gesture, id: number): Step {
  const now = removeTouch(state, id)
  if (!isPress(state.mode) || state.mode.id !== id) return { state: now, intents: [] }
  return { state: endGesture(now), intents: dropStroke(state.mode) }
}

function removeTouch(state: Gesture, id: number): Gesture {
  const touches = new Map(state.touches)
  touches.delete(id)
  const over = touches.size === 0 && (state.mode.name === 'pinch' || state.mode.name === 'ignored')
  return { ...state, touches, mode: over ? IDLE : state.mode }
}

function endGesture(state: Gesture): Gesture {
  return { ...state, mode: state.touches.size ? { name: 'ignored' } : IDLE }
}

function dropStroke(mode: Mode): Intent[] {
  return mode.name === 'draw' ? [{ type: 'drop' }] : []
}

function isPress(mode: Mode): mode is Drawing | Panning {
  return mode.name === 'draw' || mode.name === 'pan'
}

function offset([x, y]: Point, [toX, toY]: Point): Point {
  return [toX - x, toY - y]
}

function midpoint([x, y]: Point, [otherX, otherY]: Point): Point {
  return [(x + otherX) / 2, (y + otherY) / 2]
}
