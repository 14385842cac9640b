import type { Tool } from '../state'
import type { Point } from '../strokes'
import type { GestureEvent, Intent, PointerKind } from './gesture'

/** Where the events go; `tool` is the one in use at a place. */
export interface Listener {
  readonly tool: (at: Point) => Tool
  readonly gesture: (event: GestureEvent) => void
  readonly wheel: (intent: Intent) => void
  readonly hover: (at: Point | null) => void
}

type Wheel = Pick<WheelEvent, 'deltaX' | 'deltaY' | 'deltaMode' | 'ctrlKey' | 'shiftKey'>

const LINE_PX = 16
const PAGE_PX = 400
/** How much a wheel's px zoom; a trackpad's pinch gives few of them. */
const ZOOM = { wheel: 0.0018, pinch: 0.01 }
const MOST_AT_ONCE = 150

/** Hear the pointers on an element. */
export function listenToPointers(element: HTMLElement, { tool, gesture, wheel, hover }: Listener): void {
  const at = (event: MouseEvent): Point => {
    const { left, top } = element.getBoundingClientRect()
    return [event.clientX - left, event.clientY - top]
  }
  const on = <K extends keyof HTMLElementEventMap>(type: K, told: (event: HTMLElementEventMap[K]) => void) =>
    element.addEventListener(type, told, { passive: false })
  on('pointerdown', event => {
    element.setPointerCapture(event.pointerId)
    const { button, isPrimary: alone } = event
    gesture({ ...contact(event), type: 'down', at: at(event), button, alone, tool: tool(at(event)) })
  })
  // The middle button would scroll.
  on('mousedown', event => {
    if (event.button === 1) event.preventDefault()
  })
  on('pointermove', event => {
    const all = event.getCoalescedEvents()
    const path = (all.length ? all : [event]).map(at)
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
    wheel(wheeled(event, at(event)))
  })
}

/** Hear the space bar, where no control of the page would take it, until the signal. */
export function listenToSpace(element: HTMLElement, told: (held: boolean) => void, signal: AbortSignal): void {
  const heard = (event: KeyboardEvent) => {
    if (event.key !== ' ' || (event.target !== element && event.target !== document.body)) return
    event.preventDefault()
    told(event.type === 'keydown')
  }
  document.addEventListener('keydown', heard, { signal })
  document.addEventListener('keyup', heard, { signal })
  window.addEventListener('blur', () => told(false), { signal })
}

/** What a turn of the wheel at a place (CSS px) means: it zooms; sideways, or with Shift, it pans. */
export function wheeled(wheel: Wheel, about: Point): Intent {
  const unit = wheel.deltaMode === 1 ? LINE_PX : wheel.deltaMode === 2 ? PAGE_PX : 1
  const [right, down] = [wheel.deltaX * unit, wheel.deltaY * unit]
  if (!wheel.ctrlKey && wheel.shiftKey) return { type: 'pan', by: [-(right || down), 0] }
  if (!wheel.ctrlKey && right !== 0) return { type: 'pan', by: [-right, -down] }
  const turn = Math.min(Math.max(down, -MOST_AT_ONCE), MOST_AT_ONCE)
  return { type: 'pinch', factor: Math.exp(-turn * (wheel.ctrlKey ? ZOOM.pinch : ZOOM.wheel)), about, by: [0, 0] }
}

function contact({ pointerId, pointerType, width, height }: PointerEvent) {
  const pointer: PointerKind = pointerType === 'pen' || pointerType === 'touch' ? pointerType : 'mouse'
  return { id: pointerId, pointer, contact: Math.max(width, height) }
}
