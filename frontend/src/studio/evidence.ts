import type { Client, Evidence } from '../api/client'
import { isPhoto } from '../sheets'
import type { State, Traced } from '../state'
import { onSheet } from '../strokes'
import { type StrokeSketch, sketchToWire } from './sketches'

type Drawn = Pick<State, 'source' | 'photo' | 'side' | 'history'>

/** Give what a tree can be grown of; null where too little is drawn. */
export function evidenceOf(state: Drawn): Evidence | null {
  const { source, photo, history } = state
  const strokes = history.present
  if (!photo || !strokes.branches.length) return null
  const side = sideOf(state)
  const lent = isPhoto(photo) && { photo: photo.id }
  if (source === 'sketch')
    return { sketches: { front: sketchToWire(strokes, 'front', photo), ...(side && { side }) }, ...lent }
  const drawn = onSheet(strokes, 'front')
  return lent && drawn.crown ? { ...lent, strokes: drawn, ...(side && { sketches: { side } }) } : null
}

/** Whether what is drawn can be traced: a crown over a photo, a first branch on paper. */
export function canTrace({ source, photo, history }: Drawn): boolean {
  const { crown, branches } = history.present
  return source === 'sketch' ? photo !== null && branches.length > 0 : isPhoto(photo) && crown !== null
}

/** Have what is drawn traced. */
export async function traced(client: Client, state: Drawn, grow: boolean): Promise<Omit<Traced, 'of'>> {
  const { source, photo, history } = state
  const side = sideOf(state)
  if (source === 'photo') {
    return { answer: await client.trace(photo!.id!, onSheet(history.present, 'front'), grow, side ?? undefined) }
  }
  const sketches = { front: sketchToWire(history.present, 'front', photo!), ...(side && { side }) }
  const { front, side: other, ...answer } = await client.traceSketches(sketches, grow)
  const crowns = { front: front.crown, ...(other && { side: other.crown }) }
  return { answer: { ...answer, foliage: [], skeleton: front.skeleton }, crowns }
}

/** A crown alone says nothing of where branches go. */
function sideOf({ side, history }: Drawn): StrokeSketch | null {
  return side && history.present.side?.branches.length ? sketchToWire(history.present, 'side', side) : null
}
