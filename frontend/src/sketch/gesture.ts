import type { Tool } from '../state'
import type { Line, Point } from '../strokes'

export type PointerKind = 'mouse' | 'pen' | 'touch'
export type DrawnKind = 'crown' | 'branch' | 'scale'

export interface Down {
  readonly type: 'down'
  readonly id: number
  readonly pointer: PointerKind
  readonly button: number
  /** CSS px in the window, as all places here. */
  readonly at: Point
  /** The wider side of what touches the glass, CSS px. */
  readonly contact: number
  readonly tool: Tool
  /** No other pointer of its kind is down. */
  readonly alone: boolean
}

export interface Move {
  readonly type: 'move'
  readonly id: number
  readonly pointer: PointerKind
  readonly at: Point
  /** All places since the last event; ends at `at`. */
  readonly path: Line
  readonly contact: number
  /** Whether any button or the tip is down. */
  readonly pressed: boolean
}

/** What the pointers and keys do. */
export type GestureEvent =
  | Down
  | Move
  | { readonly type: 'up'; readonly id: number; readonly at: Point }
  | { readonly type: 'cancel'; readonly id: number }
  | { readonly type: 'space'; readonly held: boolean }
  | { readonly type: 'escape' }

/** What is to be done about it. */
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
  /** Whether it is a click where it does not go far. */
  readonly clicks: boolean
  readonly far: boolean
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
  /** Fingers move the photo until the last one is up. */
  | { readonly name: 'pinch' }
  /** Nothing happens until the last finger is up. */
  | { readonly name: 'spent' }

export interface Gesture {
  readonly mode: Mode
  readonly touches: ReadonlyMap<number, Point>
  /** Once a pen was seen, fingers never draw. */
  readonly penSeen: boolean
  readonly space: boolean
}

export interface Step {
  readonly state: Gesture
  readonly intents: readonly Intent[]
}

/** A pointer that goes no further is a click, CSS px. */
const TAP = 6
/** A wider contact is a palm, CSS px. */
const PALM = 50
const LEFT = 0
const MIDDLE = 1
/** Also the pen's barrel button. */
const RIGHT = 2
const IDLE: Mode = { name: 'idle' }

export const AT_REST: Gesture = { mode: IDLE, touches: new Map(), penSeen: false, space: false }

/** Say what an event means: the state after it, and what is to be done. */
export function gestured(state: Gesture, event: GestureEvent): Step {
  if (event.type === 'down') return pressed(state, event)
  if (event.type === 'move') return moved(state, event)
  if (event.type === 'up') return lifted(state, event)
  if (event.type === 'cancel') return canceled(state, event.id)
  if (event.type === 'space') return { state: { ...state, space: event.held }, intents: [] }
  return { state: rested(state), intents: dropped(state.mode) }
}

function pressed(state: Gesture, event: Down): Step {
  const palm = event.pointer === 'touch' && event.contact > PALM
  if (palm || ![LEFT, MIDDLE, RIGHT].includes(event.button)) return { state, intents: [] }
  if (event.pointer === 'touch') return touched(state, event)
  return begun({ ...state, penSeen: state.penSeen || event.pointer === 'pen' }, event)
}

function touched(state: Gesture, event: Down): Step {
  // An end that was never heard of would leave a finger behind.
  const touches = new Map(event.alone ? [] : state.touches).set(event.id, event.at)
  const now = { ...state, touches }
  if (isPress(state.mode) && state.mode.pointer !== 'touch') return { state: now, intents: [] }
  if (touches.size === 1) return begun(now, event)
  if (state.mode.name === 'spent') return { state: now, intents: [] }
  return { state: { ...now, mode: { name: 'pinch' } }, intents: dropped(state.mode) }
}

function begun(state: Gesture, event: Down): Step {
  const { id, pointer, at, button, tool } = event
  const press = { id, pointer, from: at, far: false }
  const before = dropped(state.mode)
  const kind = drawnBy(state, event)
  if (kind === null) {
    const clicks = button === LEFT && !state.space
    return { state: { ...state, mode: { ...press, name: 'pan', at, clicks } }, intents: before }
  }
  const clicks = button === LEFT && kind === tool
  return {
    state: { ...state, mode: { ...press, name: 'draw', kind, clicks } },
    intents: [...before, { type: 'begin', kind, at }],
  }
}

/** What a press draws; null where it moves the photo. */
function drawnBy({ space, penSeen }: Gesture, { button, pointer, tool }: Down): DrawnKind | null {
  if (button === MIDDLE || (button === LEFT && space) || (pointer === 'touch' && penSeen)) return null
  if (button === RIGHT) return 'branch'
  return tool === 'select' ? null : tool
}

function moved(state: Gesture, event: Move): Step {
  const { id, at, pointer } = event
  const before = state.touches
  const touches = before.has(id) ? new Map(before).set(id, at) : before
  const now = { ...state, touches, penSeen: state.penSeen || pointer === 'pen' }
  if (pointer === 'touch' && event.contact > PALM) return canceled(state, id)
  const { mode } = state
  if (mode.name === 'pinch') return { state: now, intents: pinched(before, touches) }
  if (!isPress(mode) || mode.id !== id) return { state: now, intents: [] }
  if (!event.pressed) return lifted(now, { id, at })
  return mode.name === 'draw' ? extended(now, mode, event) : panned(now, mode, event)
}

function extended(state: Gesture, mode: Drawing, { path }: Move): Step {
  const far = mode.far || path.some(place => apart(mode.from, place) >= TAP)
  return { state: { ...state, mode: { ...mode, far } }, intents: [{ type: 'extend', path }] }
}

function panned(state: Gesture, mode: Panning, { at }: Move): Step {
  const far = mode.far || !mode.clicks || apart(mode.from, at) >= TAP
  if (!far) return { state, intents: [] }
  return { state: { ...state, mode: { ...mode, far, at } }, intents: [{ type: 'pan', by: between(mode.at, at) }] }
}

/** Follow the first two fingers, or the one that is left. */
function pinched(before: ReadonlyMap<number, Point>, after: ReadonlyMap<number, Point>): Intent[] {
  const [a, b] = [...before.values()]
  const [c, d] = [...after.values()]
  if (!a || !c || before === after) return []
  if (!b || !d) return [{ type: 'pan', by: between(a, c) }]
  const about = middle(c, d)
  const factor = Math.max(apart(c, d), 1) / Math.max(apart(a, b), 1)
  return [{ type: 'pinch', factor, about, by: between(middle(a, b), about) }]
}

function lifted(state: Gesture, { id, at }: { readonly id: number; readonly at: Point }): Step {
  const { mode } = state
  const now = without(state, id)
  if (!isPress(mode) || mode.id !== id) return { state: now, intents: [] }
  const click: Intent[] = mode.clicks && !mode.far ? [{ type: 'click', at, pointer: mode.pointer }] : []
  if (mode.name === 'pan') return { state: rested(now), intents: click }
  const end: Intent[] = mode.far ? [{ type: 'extend', path: [at] }, { type: 'end' }] : [{ type: 'drop' }, ...click]
  return { state: rested(now), intents: end }
}

function canceled(state: Gesture, id: number): Step {
  const now = without(state, id)
  if (!isPress(state.mode) || state.mode.id !== id) return { state: now, intents: [] }
  return { state: rested(now), intents: dropped(state.mode) }
}

function without(state: Gesture, id: number): Gesture {
  const touches = new Map(state.touches)
  touches.delete(id)
  const over = touches.size === 0 && (state.mode.name === 'pinch' || state.mode.name === 'spent')
  return { ...state, touches, mode: over ? IDLE : state.mode }
}

function rested(state: Gesture): Gesture {
  return { ...state, mode: state.touches.size ? { name: 'spent' } : IDLE }
}

function dropped(mode: Mode): Intent[] {
  return mode.name === 'draw' ? [{ type: 'drop' }] : []
}

function isPress(mode: Mode): mode is Drawing | Panning {
  return mode.name === 'draw' || mode.name === 'pan'
}

function between([x, y]: Point, [toX, toY]: Point): Point {
  return [toX - x, toY - y]
}

function middle([x, y]: Point, [otherX, otherY]: Point): Point {
  return [(x + otherX) / 2, (y + otherY) / 2]
}

function apart([x, y]: Point, [otherX, otherY]: Point): number {
  return Math.hypot(otherX - x, otherY - y)
}
