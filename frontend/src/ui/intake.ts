import { isEmpty } from '../strokes'
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

/** Open what is dropped on the page or pasted into it. */
export function takeFiles(studio: Studio): void {
  const veil = el('div', { class: 'drop-veil', hidden: true }, el('p', {}, text.welcome.drop))
  document.body.append(veil)
  let leaving = 0
  addEventListener('dragover', event => {
    if (!event.dataTransfer?.types.includes('Files')) return
    event.preventDefault()
    veil.hidden = false
    clearTimeout(leaving)
    leaving = window.setTimeout(() => {
      veil.hidden = true
    }, 300)
  })
  addEventListener('drop', event => {
    event.preventDefault()
    veil.hidden = true
    openOne(studio, [...(event.dataTransfer?.files ?? [])])
  })
  addEventListener('paste', event => {
    const picture = [...(event.clipboardData?.files ?? [])].find(isPhoto)
    if (picture) openFile(studio, named(picture))
  })
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
