import { isEmpty } from '../../strokes'
import { isPicture, TYPES } from '../../studio/photos'
import { isProject } from '../../studio/project'
import type { Studio } from '../../studio/studio'
import { isVideo, VIDEO_TYPES } from '../../studio/videos'
import { text } from '../../text'

const PHOTOS = [...new Set(Object.values(TYPES)), ...Object.keys(TYPES).map(ending => `.${ending}`)].join()
/** What systems put into folders. */
const HIDDEN = /^\.|^(Thumbs\.db|desktop\.ini)$/i
const VIDEOS = ['video/*', 'image/gif', ...Object.keys(VIDEO_TYPES).map(ending => `.${ending}`)].join()
const PROJECTS = '.treestroke'
const SKETCHES = 'image/png,application/json,.json'

/** Ask before a drawing is left that the browser could not keep; false where the user wants to stay. */
export function mayLeave({ store }: Studio): boolean {
  return store.state.kept || !store.state.sheets || isEmpty(store.strokes) || confirm(text.header.leave)
}

/** Let the user choose photos or a project on the disk, and open them. */
export function choose(studio: Studio, what: 'photo' | 'any' = 'any'): void {
  fromDisk(what === 'photo' ? PHOTOS : `${PHOTOS},${VIDEOS},${PROJECTS}`, files => openFiles(studio, files), {
    multiple: true,
  })
}

/** Let the user choose many photos of one tree. */
export function choosePhotos(studio: Studio): void {
  fromDisk(PHOTOS, files => openFiles(studio, files), { multiple: true })
}

/** Let the user choose a folder with photos of one tree. */
export function chooseFolder(studio: Studio): void {
  const take = (files: readonly File[]) => {
    const inside = files.filter(({ webkitRelativePath: path }) => path.split('/').length <= 2)
    openFiles(studio, inside, inside[0]?.webkitRelativePath.split('/')[0])
  }
  fromDisk('', take, { webkitdirectory: true })
}

/** Let the user choose photos for the open tree. */
export function chooseMore({ captures }: Studio): void {
  fromDisk(PHOTOS, files => void captures.add(files.filter(isPicture)), { multiple: true })
}

/** Let the user choose a video of a tree. */
export function chooseVideo(take: (file: File) => void): void {
  fromDisk(VIDEOS, ([file]) => take(file!))
}

/** Say what becomes of a video that was chosen, before it is sent. */
export function offerVideo({ store }: Studio, clipOffer: File): void {
  store.fault('photo', null)
  store.set({ dialog: 'clip', clipOffer })
}

/** Let the user choose a picture on the disk. */
export function choosePicture(take: (file: File) => void): void {
  fromDisk(PHOTOS, ([file]) => take(file!))
}

/** Let the user choose a sketch on the disk: a picture of it, or its strokes. */
export function chooseSketch(take: (file: File) => void): void {
  fromDisk(SKETCHES, ([file]) => take(file!))
}

/** Open what was chosen or dropped together: a project or a photo, or many photos or a video after it is said what becomes of them. */
export function openFiles(studio: Studio, files: readonly File[], folder = ''): void {
  const photos = files.filter(isPicture)
  const one = files.find(isProject) ?? (photos.length === 1 ? photos[0] : undefined)
  const video = files.find(isVideo)
  if (one) openFile(studio, one)
  else if (video && !photos.length) offerVideo(studio, video)
  else if (photos.length) offerPhotos(studio, photos, files, folder)
  else if (files.length) studio.store.fault('photo', { text: text.welcome.unknownFile })
}

function offerPhotos({ store }: Studio, photos: readonly File[], files: readonly File[], name: string): void {
  const others = files.filter(file => !photos.includes(file) && !HIDDEN.test(file.name))
  store.set({ dialog: 'photos', offer: { photos, others: others.map(other => other.name), name } })
}

/** Open a photo or a project in the place of the present drawing. */
export function openFile(studio: Studio, file: File): void {
  if (mayLeave(studio)) void studio.opener.openFile(file)
}

/** Open a sketch in the place of the present drawing. */
export function openSketch(studio: Studio, file: File): void {
  if (mayLeave(studio)) void studio.opener.openSketch(file)
}

function fromDisk(
  accept: string,
  take: (files: readonly File[]) => void,
  how: Pick<Partial<HTMLInputElement>, 'multiple' | 'webkitdirectory'> = {},
): void {
  const input: HTMLInputElement = document.createElement('input')
  Object.assign(input, { type: 'file', accept, ...how })
  input.addEventListener('change', () => input.files?.length && take([...input.files]))
  input.click()
}
