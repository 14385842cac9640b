import type { Client, Inputs } from '../api/client'
import type { Settings, StrokeSketch } from '../api/types'
import { hasPhoto } from '../sheets'
import type { State, Traced } from '../state'
import { onSheet } from '../strokes'
import { sketchToWire } from './sketches'

type Drawn = Pick<State, 'sheets' | 'history'>

/** The settings that change the form of the branches, which is all that a live tree shows. */
const LIVE_SETTINGS = ['library', 'iterations', 'form', 'edge', 'species', 'season', 'foliage'] as const
type LiveSettings = Pick<Settings, (typeof LIVE_SETTINGS)[number]>

/** Return the inputs for a model; null where too little is drawn. */
export function inputsOf({ sheets, history }: Drawn): Inputs | null {
  const strokes = history.present
  if (!sheets || !strokes.branches.length) return null
  const side = sideSketch({ sheets, history })
  if (sheets.source === 'sketch') {
    const sketches = { front: sketchToWire(strokes, 'front', sheets.front), ...(side && { side }) }
    return { sketches, ...(hasPhoto(sheets.front) && { photo: sheets.front.id }) }
  }
  const drawn = onSheet(strokes, 'front')
  return drawn.crown && { photo: sheets.front.id, strokes: drawn, ...(side && { sketches: { side } }) }
}

/** Return whether enough is drawn to be traced: a crown over a photo, or a first branch on paper. */
export function canTrace({ sheets, history }: Drawn): boolean {
  const { crown, branches } = history.present
  return sheets?.source === 'sketch' ? branches.length > 0 : sheets !== null && crown !== null
}

/** Return the settings that the live tree grows by; null where it is sketched: it grows by defaults then. */
export function liveSettings({ sheets, settings }: Pick<State, 'sheets' | 'settings'>): LiveSettings | null {
  if (sheets?.source !== 'photo') return null
  return Object.fromEntries(LIVE_SETTINGS.map(name => [name, settings[name]])) as unknown as LiveSettings
}

/** Ask the service to trace what is drawn, and with `grow` for the live tree too; return what it found. */
export async function traced(
  client: Client,
  { sheets, history, settings }: Drawn & Pick<State, 'settings'>,
  grow: boolean,
): Promise<Omit<Traced, 'of'>> {
  const side = sideSketch({ sheets, history })
  if (sheets!.source === 'photo') {
    const chosen = grow ? liveSettings({ sheets, settings }) : null
    const asked = { grow, ...(chosen && { settings: chosen }), ...(side && { side }) }
    return { answer: await client.trace(sheets!.front.id!, onSheet(history.present, 'front'), asked) }
  }
  const sketches = { front: sketchToWire(history.present, 'front', sheets!.front), ...(side && { side }) }
  const { front, side: other, ...answer } = await client.traceSketches(sketches, grow)
  const crowns = { front: front.crown, ...(other && { side: other.crown }) }
  return { answer: { ...answer, foliage: [], skeleton: front.skeleton, taken: null }, crowns }
}

/** Return the side's sketch; null where it has no branch, since a crown alone says nothing about depth. */
function sideSketch({ sheets, history }: Drawn): StrokeSketch | null {
  const { side } = history.present
  return sheets?.side && side?.branches.length ? sketchToWire(history.present, 'side', sheets.side) : null
}
