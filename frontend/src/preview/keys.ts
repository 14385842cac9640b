import type { View } from './status'

/** What the keys of the canvas move. */
export interface Keyed {
  orbit(azimuth: number, polar: number): void
  zoom(factor: number): void
  view(name: View): void
  turnLeaves(): void
}

const VIEWS: View[] = ['photo', 'front', 'side', 'back', 'top']
const TURN = Math.PI / 18
const ARROWS: Record<string, [number, number]> = {
  ArrowLeft: [-TURN, 0],
  ArrowRight: [TURN, 0],
  ArrowUp: [0, -TURN],
  ArrowDown: [0, TURN],
}

/** Act on a key of the canvas: arrows orbit, + and - zoom, 1 to 5 are the views, L the leaves; says whether it was one. */
export function press(key: string, keyed: Keyed): boolean {
  const arrow = ARROWS[key]
  const view = VIEWS[Number(key) - 1]
  if (arrow) keyed.orbit(...arrow)
  else if (view) keyed.view(view)
  else if (key === '+' || key === '=') keyed.zoom(1.2)
  else if (key === '-') keyed.zoom(1 / 1.2)
  else if (key === 'l' || key === 'L') keyed.turnLeaves()
  else return false
  return true
}
