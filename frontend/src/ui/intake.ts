import { isPaper } from '../sheets'
import { isEmpty, type SheetName } from '../strokes'
import { isPicture, TYPES, typeOf } from '../studio/photos'
import { isProject } from '../studio/project'
import type { Studio } from '../studio/studio'
import { text } from '../text'
import { el } from './dom'
import { dropVeil, type Way } from './dropVeil'

const PHOTOS = [...new Set(Object.values(TYPES)), ...Object.keys(TYPES).map(ending => `.${ending}`)].join()
const PROJECTS = '.treestroke'
const SKETCHES = 'image/png,application/json,.json'

/** Ask before a drawing is left that the browser could not keep. */
export function mayLeave({ store }: Studio): boolean {
  return store.state.kept || !store.state.photo || isEmpty(store.strokes) || confirm(text.header.leave)
}

/** Let the user choose a photo or a project on the disk. */
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

/** Open a sketch in the place of the present drawing. */
export function openSketch(studio: Studio, file: File): void {
  if (mayLeave(studio)) void studio.opener.openSketch(file)
}

/** Open what is dropped on the page or pasted into it. */
export function takeFiles(studio: Studio): void {
  const veil = dropVeil()
  addEventListener('dragover', event => {
    if (!event.dataTransfer?.types.includes('Files')) return
    event.preventDefault()
    veil.show(
      waysOf(
        studio,
        event,
        [...event.dataTransfer.items].map(({ type }) => type),
      ),
      event,
    )
  })
  addEventListener('drop', event => {
    event.preventDefault()
    veil.hide()
    const files = [...(event.dataTransfer?.files ?? [])]
    const picture = files.find(file => isPicture(file) || isStrokes(file))
    const way = picture && veil.wayAt(waysOf(studio, event, files.map(typeOf)), event)
    if (way?.take) way.take(picture!)
    else openOne(studio, files)
  })
  addEventListener('paste', event => {
    const picture = [...(event.clipboardData?.files ?? [])].find(isPicture)
    if (picture) openFile(studio, named(picture))
  })
}

/** List what can become of what is dragged, by its types: a PNG may be a photo or a drawing, which only the user knows. */
function waysOf(studio: Studio, event: DragEvent, kinds: readonly string[]): readonly Way[] {
  const { drop } = text.sheets
  const [part, sheet] = sheetUnder(studio, event)
  const drawing: Way = sheet
    ? { words: drop.drawing, over: part, take: file => void studio.opener.openOn(sheet, file) }
    : { words: drop.drawing, take: file => openSketch(studio, file) }
  const photo: Way = sheet
    ? { words: drop.lay, over: part, take: file => void studio.desk.lay(sheet, file) }
    : { words: drop.photo, take: file => openFile(studio, file) }
  if (kinds.includes('image/png')) return [photo, drawing]
  if (kinds.includes('application/json')) return [drawing]
  return [sheet && kinds.some(kind => kind.startsWith('image/')) ? photo : { words: [text.welcome.drop] }]
}

/** Find the sheet of paper that something is dragged over. */
function sheetUnder({ store }: Studio, { target }: DragEvent): readonly [Element, SheetName] | readonly [] {
  const part = target instanceof Element ? target.closest<HTMLElement>('[data-of]') : null
  const sheet = part?.dataset.of as SheetName | undefined
  return part && sheet && isPaper(store.state, sheet) ? [part, sheet] : []
}

function fromDisk(accept: string, take: (file: File) => void): void {
  const input = el('input', { type: 'file', accept })
  input.addEventListener('change', () => input.files?.[0] && take(input.files[0]))
  input.click()
}

function openOne(studio: Studio, files: readonly File[]): void {
  const file = files.find(one => isPicture(one) || isProject(one))
  if (file) openFile(studio, file)
  else if (files.length) studio.store.fault('photo', { text: text.welcome.notThis })
}

function openFile(studio: Studio, file: File): void {
  if (mayLeave(studio)) void studio.opener.openFile(file)
}

function isStrokes(file: File): boolean {
  return file.type === 'application/json'
}

function named(picture: File): File {
  return new File([picture], `${text.welcome.pasted}.${picture.type.split('/')[1]}`, { type: picture.type })
}
