import { isEmpty } from '../../strokes'
import { TYPES } from '../../studio/photos'
import type { Studio } from '../../studio/studio'
import { text } from '../../text'

const PHOTOS = [...new Set(Object.values(TYPES)), ...Object.keys(TYPES).map(ending => `.${ending}`)].join()
const PROJECTS = '.treestroke'
const SKETCHES = 'image/png,application/json,.json'

/** Ask before a drawing is left that the browser could not keep; false where the user wants to stay. */
export function mayLeave({ store }: Studio): boolean {
  return store.state.kept || !store.state.sheets || isEmpty(store.strokes) || confirm(text.header.leave)
}

/** Let the user choose a photo or a project on the disk, and open it. */
export function choose(studio: Studio, what: 'photo' | 'any' = 'any'): void {
  fromDisk(what === 'photo' ? PHOTOS : `${PHOTOS},${PROJECTS}`, file => openFile(studio, file))
}

/** Let the user choose a picture on the disk. */
export function choosePicture(take: (file: File) => void): void {
  fromDisk(PHOTOS, take)
}

/** Let the user choose a sketch on the disk: a picture of it, or its strokes. */
export function chooseSketch(take: (file: File) => void): void {
  fromDisk(SKETCHES, take)
}

/** Open a photo or a project in the place of the present drawing. */
export function openFile(studio: Studio, file: File): void {
  if (mayLeave(studio)) void studio.opener.openFile(file)
}

/** Open a sketch in the place of the present drawing. */
export function openSketch(studio: Studio, file: File): void {
  if (mayLeave(studio)) void studio.opener.openSketch(file)
}

function fromDisk(accept: string, take: (file: File) => void): void {
  const input = Object.assign(document.createElement('input'), { type: 'file', accept })
  input.addEventListener('change', () => input.files?.[0] && take(input.files[0]))
  input.click()
}
