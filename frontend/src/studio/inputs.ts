import type { Client, Inputs } from '../api/client'
import type { Settings, StrokeSketch } from '../api/types'
import { hasPhoto } from '../sheets'
import type { State, Traced } from '../state'
import { onSheet, type Strokes } from '../strokes'
import { sketchToWire } from './sketches'

type Drawn = Pick<State, 'sheets' | 'history'>

/** The settings that change the form of the branches, which is all that a live tree shows. */
const LIVE_SETTINGS = ['library', 'iterations', 'form', 'edge', 'species', 'season', 'foliage'] as const
type LiveSettings = Pick<Settings, (typeof LIVE_SETTINGS)[number]>

/** Return the inputs for a model; null where too little is drawn. */
export function inputsOf({ sheets, history }: Drawn): Inputs | null {
  const strokes = history.present
  if (!sheets || !isEnough({ sheets, history })) return null
  const side = sideSketch({ sheets, history })
  if (sheets.source === 'sketch') {
    const sketches = { front: sketchToWire(strokes, 'front', sheets.front), ...(side && { side }) }
    return { sketches, ...(hasPhoto(sheets.front) && { photo: sheets.front.id }) }
  }
  if (sheets.source === 'capture')
    return canTrace({ sheets, history }) ? { capture: sheets.capture.id!, strokes } : null
  if (sheets.source === 'clip') return canTrace({ sheets, history }) ? { clip: sheets.clip.id!, strokes } : null
  const drawn = onSheet(strokes, 'front')
  return drawn.crown && { photo: sheets.front.id, strokes: drawn, ...(side && { sketches: { side } }) }
}

/** Return whether a branch is drawn on the front; the first is the trunk. Of many photos, on one with a crown. */
export function hasTrunk({ branches, views = [] }: Strokes): boolean {
  return branches.length > 0 || views.some(view => view.crown && view.branches.length > 0)
}

/** Return whether enough is drawn for a whole tree: a trunk, or over a clip a crown. */
export function isEnough({ sheets, history }: Drawn): boolean {
  return sheets?.source === 'clip' ? history.present.crown !== null : hasTrunk(history.present)
}

/**
 * Return whether enough is there to be traced: a crown over a photo, a first branch on paper, or the cameras of many photos
 * and a crown and a trunk over one of them.
 */
export function canTrace({ sheets, history }: Drawn): boolean {
  if (sheets?.source === 'capture')
    return sheets.capture.id !== null && sheets.capture.cameras.length > 0 && hasTrunk(history.present)
  const { crown, branches } = history.present
  if (sheets?.source === 'clip' && sheets.clip.id === null) return false
  return sheets?.source === 'sketch' ? branches.length > 0 : sheets !== null && crown !== null
}

/** Return the settings that the live tree grows by; null where it is sketched: it grows by defaults then. */
export function liveSettings({ sheets, settings }: Pick<State, 'sheets' | 'settings'>): LiveSettings | null {
  if (!sheets || sheets.source === 'sketch') return null
  return Object.fromEntries(LIVE_SETTINGS.map(name => [name, settings[name]])) as unknown as LiveSettings
}

/** Ask the service to trace what is drawn, and with `grow` for the live tree too; return what it found. */
export async function traced(
  client: Client,
  { sheets, history, settings }: Drawn & Pick<State, 'settings'>,
  grow: boolean,
): Promise<Omit<Traced, 'of'>> {
  const side = sideSketch({ sheets, history })
  const chosen = grow ? liveSettings({ sheets, settings }) : null
  const asked = { grow, ...(chosen && { settings: chosen }) }
  const drawn = onSheet(history.present, 'front')
  if (sheets!.source === 'capture')
    return { answer: await client.traceCapture(sheets!.capture.id!, history.present, asked) }
  if (sheets!.source === 'clip') return { answer: await client.traceClip(sheets!.clip.id!, drawn, asked) }
  if (sheets!.source === 'photo')
    return { answer: await client.trace(sheets!.front.id!, drawn, { ...asked, ...(side && { side }) }) }
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
