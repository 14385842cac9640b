import type { Client, Inputs } from '../api/client'
import type { StrokeSketch } from '../api/types'
import { hasPhoto } from '../sheets'
import type { State, Traced } from '../state'
import { onSheet } from '../strokes'
import { sketchToWire } from './sketches'

type Drawn = Pick<State, 'sheets' | 'history'>

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

/** Ask the service to trace what is drawn, and with `grow` for the live tree too; return what it found. */
export async function traced(client: Client, { sheets, history }: Drawn, grow: boolean): Promise<Omit<Traced, 'of'>> {
  const side = sideSketch({ sheets, history })
  if (sheets!.source === 'photo') {
    return { answer: await client.trace(sheets!.front.id!, onSheet(history.present, 'front'), grow, side ?? undefined) }
  }
  const sketches = { front: sketchToWire(history.present, 'front', sheets!.front), ...(side && { side }) }
  const { front, side: other, ...answer } = await client.traceSketches(sketches, grow)
  const crowns = { front: front.crown, ...(other && { side: other.crown }) }
  return { answer: { ...answer, foliage: [], skeleton: front.skeleton }, crowns }
}

/** Return the side's sketch; null where it has no branch, since a crown alone says nothing about depth. */
function sideSketch({ sheets, history }: Drawn): StrokeSketch | null {
  const { side } = history.present
  return sheets?.side && side?.branches.length ? sketchToWire(history.present, 'side', sheets.side) : null
}
