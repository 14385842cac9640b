import { isPaper } from '../sheets'
import { isEmpty, type SheetName } from '../strokes'
import { isProject } from '../studio/project'
import type { Studio } from '../studio/studio'
import { text } from '../text'
import { el } from './dom'
import './intake.css'

const PHOTOS = 'image/jpeg,image/png,image/webp'
const PROJECTS = '.treestroke'

/** Ask before a drawing is left that the browser could not keep. */
export function mayLeave({ store }: Studio): boolean {
  return store.state.kept || !store.state.photo || isEmpty(store.strokes) || confirm(text.header.leave)
}

/** Let the user choose a photo or a project on the disk. */
export function choose(studio: Studio, what: 'photo' | 'any' = 'any'): void {
  const input = el('input', { type: 'file', accept: what === 'photo' ? PHOTOS : `${PHOTOS},${PROJECTS}` })
  input.addEventListener('change', () => input.files?.[0] && openFile(studio, input.files[0]))
  input.click()
}

/** Let the user choose a picture on the disk. */
export function choosePicture(take: (file: File) => void): void {
  const input = el('input', { type: 'file', accept: PHOTOS })
  input.addEventListener('change', () => input.files?.[0] && take(input.files[0]))
  input.click()
}

/** Open what is dropped on the page or pasted into it. */
export function takeFiles(studio: Studio): void {
  const says = el('p', {})
  const veil = el('div', { class: 'drop-veil', hidden: true }, says)
  document.body.append(veil)
  let leaving = 0
  addEventListener('dragover', event => {
    if (!event.dataTransfer?.types.includes('Files')) return
    event.preventDefault()
    veil.hidden = false
    says.textContent = sheetUnder(studio, event) ? text.sheets.drop : text.welcome.drop
    clearTimeout(leaving)
    leaving = window.setTimeout(() => {
      veil.hidden = true
    }, 300)
  })
  addEventListener('drop', event => {
    event.preventDefault()
    veil.hidden = true
    const files = [...(event.dataTransfer?.files ?? [])]
    const [sheet, picture] = [sheetUnder(studio, event), files.find(isPhoto)]
    if (sheet && picture) void studio.desk.lay(sheet, picture)
    else openOne(studio, files)
  })
  addEventListener('paste', event => {
    const picture = [...(event.clipboardData?.files ?? [])].find(isPhoto)
    if (picture) openFile(studio, named(picture))
  })
}

/** Find the sheet of paper that something is dropped on. */
function sheetUnder({ store }: Studio, { target }: DragEvent): SheetName | null {
  const part = target instanceof Element ? target.closest<HTMLElement>('[data-of]') : null
  const sheet = part?.dataset.of as SheetName | undefined
  return sheet && isPaper(store.state, sheet) ? sheet : null
}

function openOne(studio: Studio, files: readonly File[]): void {
  const file = files.find(one => isPhoto(one) || isProject(one))
  if (file) openFile(studio, file)
  else if (files.length) studio.store.fault('photo', { text: text.welcome.notThis })
}

function openFile(studio: Studio, file: File): void {
  if (mayLeave(studio)) void studio.opener.openFile(file)
}

/** Let the service judge any picture; it names the formats that it takes. */
function isPhoto(file: File): boolean {
  return file.type.startsWith('image/')
}

function named(picture: File): File {
  return new File([picture], `${text.welcome.pasted}.${picture.type.split('/')[1]}`, { type: picture.type })
}
