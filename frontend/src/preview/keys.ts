import type { View } from './status'

/** What the keys of the canvas act on. */
export interface KeyTarget {
  orbit(azimuth: number, polar: number): void
  zoom(factor: number): void
  view(name: View): void
  toggleLeaves(): void
}

const VIEWS: View[] = ['photo', 'front', 'side', 'back', 'top']
/** Radians for each key press. */
const TURN = Math.PI / 18
const ZOOM = 1.2
const ARROWS: Record<string, [number, number]> = {
  ArrowLeft: [-TURN, 0],
  ArrowRight: [TURN, 0],
  ArrowUp: [0, -TURN],
  ArrowDown: [0, TURN],
}

/** Act on a key (arrows orbit, + and - zoom, 1 to 5 show views, L toggles the leaves); returns whether it is one of these. */
export function pressKey(key: string, target: KeyTarget): boolean {
  const arrow = ARROWS[key]
  const view = VIEWS[Number(key) - 1]
  if (arrow) target.orbit(...arrow)
  else if (view) target.view(view)
  else if (key === '+' || key === '=') target.zoom(ZOOM)
  else if (key === '-') target.zoom(1 / ZOOM)
  else if (key === 'l' || key === 'L') target.toggleLeaves()
  else return false
  return true
}
