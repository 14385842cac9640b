import { captureOf, captureSheet } from '../../sheets'
import type { Store } from '../../state'

/** Draw on another photo of many, by its name. */
export function choosePhoto(store: Store, name: string): void {
  const { sheets } = store.state
  const photo = captureOf({ sheets })?.photos.find(other => other.name === name)
  if (photo && sheets?.source === 'capture') store.set({ sheets: { ...sheets, front: captureSheet(photo) } })
}
