import type { Tool } from '../state'
import type { Point } from '../strokes'
import type { GestureEvent, Intent, PointerKind } from './gesture'

/** Receives the events of the pointers; all points are CSS px in the window. */
export interface Listener {
  /** Returns the tool that a press at a point uses. */
  readonly tool: (at: Point) => Tool
  readonly gesture: (event: GestureEvent) => void
  readonly wheel: (intent: Intent) => void
  /** Null where no mouse or pen is over the element. */
  readonly hover: (at: Point | null) => void
}

type Wheel = Pick<WheelEvent, 'deltaX' | 'deltaY' | 'deltaMode' | 'ctrlKey' | 'shiftKey'>

/** What lines and pages of a wheel count as, px. */
const LINE_PX = 16
const PAGE_PX = 400
/** Growth of the scale's logarithm per px of a wheel; a trackpad's pinch reports fewer px. */
const ZOOM_RATE = { wheel: 0.0018, pinch: 0.01 }
/** The most that one event zooms, px. */
const MAX_DELTA = 150

/** Listen to the pointers and the wheel on an element. */
export function listenToPointers(element: HTMLElement, { tool, gesture, wheel, hover }: Listener): void {
  const at = (event: MouseEvent): Point => {
    const { left, top } = element.getBoundingClientRect()
    return [event.clientX - left, event.clientY - top]
  }
  const on = <K extends keyof HTMLElementEventMap>(type: K, listener: (event: HTMLElementEventMap[K]) => void) =>
    element.addEventListener(type, listener, { passive: false })
  on('pointerdown', event => {
    element.setPointerCapture(event.pointerId)
    const { button, isPrimary: alone } = event
    gesture({ ...contact(event), type: 'down', at: at(event), button, alone, tool: tool(at(event)) })
  })
  // The middle button would otherwise scroll the page.
  on('mousedown', event => {
    if (event.button === 1) event.preventDefault()
  })
  on('pointermove', event => {
    const events = event.getCoalescedEvents()
    const path = (events.length ? events : [event]).map(at)
    gesture({ ...contact(event), type: 'move', at: at(event), path, pressed: event.buttons !== 0 })
    hover(event.pointerType === 'touch' ? null : at(event))
  })
  on('pointerup', event => gesture({ type: 'up', id: event.pointerId, at: at(event) }))
  on('pointercancel', event => gesture({ type: 'cancel', id: event.pointerId }))
  on('lostpointercapture', event => gesture({ type: 'cancel', id: event.pointerId }))
  on('pointerleave', () => hover(null))
  on('contextmenu', event => event.preventDefault())
  on('wheel', event => {
    event.preventDefault()
    wheel(wheelIntent(event, at(event)))
  })
}

/** Listen to the space bar until the signal, unless a control of the page has the focus. */
export function listenToSpace(element: HTMLElement, onChange: (held: boolean) => void, signal: AbortSignal): void {
  const listener = (event: KeyboardEvent) => {
    if (event.key !== ' ' || (event.target !== element && event.target !== document.body)) return
    event.preventDefault()
    onChange(event.type === 'keydown')
  }
  document.addEventListener('keydown', listener, { signal })
  document.addEventListener('keyup', listener, { signal })
  window.addEventListener('blur', () => onChange(false), { signal })
}

/** Return what a turn of the wheel over a point (CSS px) means: zoom, or pan if it is sideways or with Shift. */
export function wheelIntent(wheel: Wheel, about: Point): Intent {
  const unit = wheel.deltaMode === 1 ? LINE_PX : wheel.deltaMode === 2 ? PAGE_PX : 1
  const [right, down] = [wheel.deltaX * unit, wheel.deltaY * unit]
  if (!wheel.ctrlKey && wheel.shiftKey) return { type: 'pan', by: [-(right || down), 0] }
  if (!wheel.ctrlKey && right !== 0) return { type: 'pan', by: [-right, -down] }
  const turn = Math.min(Math.max(down, -MAX_DELTA), MAX_DELTA)
  return {
    type: 'pinch',
    factor: Math.exp(-turn * (wheel.ctrlKey ? ZOOM_RATE.pinch : ZOOM_RATE.wheel)),
    about,
    by: [0, 0],
  }
}

function contact({ pointerId, pointerType, width, height }: PointerEvent) {
  const pointer: PointerKind = pointerType === 'pen' || pointerType === 'touch' ? pointerType : 'mouse'
  return { id: pointerId, pointer, contact: Math.max(width, height) }
}
