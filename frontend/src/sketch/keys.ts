import type { Point } from '../strokes'
import type { Size } from './viewport'
import { within } from './viewport'

/** A command that a key gives to the canvas. */
export type KeyCommand =
  | { readonly type: 'step'; readonly right: number; readonly down: number; readonly fine: boolean }
  | { readonly type: 'zoom'; readonly factor: number }
  | { readonly type: 'pen' | 'escape' | 'remove' | 'fit' | 'actual' }

type Key = Pick<KeyboardEvent, 'key' | 'shiftKey' | 'ctrlKey' | 'metaKey' | 'altKey'>

/** An arrow key's steps, as shares of the sheet's longer side. */
const STEP = 0.02
const FINE_STEP = 0.0025
const ZOOM = 1.25
const ARROWS: Readonly<Record<string, Point>> = {
  ArrowLeft: [-1, 0],
  ArrowRight: [1, 0],
  ArrowUp: [0, -1],
  ArrowDown: [0, 1],
}
const COMMANDS: Readonly<Record<string, KeyCommand>> = {
  Enter: { type: 'pen' },
  Escape: { type: 'escape' },
  Delete: { type: 'remove' },
  Backspace: { type: 'remove' },
  '+': { type: 'zoom', factor: ZOOM },
  '=': { type: 'zoom', factor: ZOOM },
  '-': { type: 'zoom', factor: 1 / ZOOM },
  '0': { type: 'fit' },
  '1': { type: 'actual' },
}

/** Return a key's command; null where it has none. */
export function keyCommand({ key, shiftKey, ctrlKey, metaKey, altKey }: Key): KeyCommand | null {
  if (ctrlKey || metaKey || altKey) return null
  const arrow = ARROWS[key]
  if (arrow) return { type: 'step', right: arrow[0], down: arrow[1], fine: shiftKey }
  return COMMANDS[key] ?? null
}

/** Return the point one step further, within a sheet of this size; sheet px. */
export function stepFrom([x, y]: Point, step: KeyCommand & { type: 'step' }, { width, height }: Size): Point {
  const length = (step.fine ? FINE_STEP : STEP) * Math.max(width, height)
  return [within(x + step.right * length, 0, width), within(y + step.down * length, 0, height)]
}
