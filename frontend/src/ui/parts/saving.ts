import { projectName, writeProject } from '../../studio/project'
import type { Studio } from '../../studio/studio'
import { text } from '../../text'

const KEPT_MS = 60_000

/** Have the browser save a file. */
export function saveFile(file: Blob, name: string): void {
  const href = URL.createObjectURL(file)
  Object.assign(document.createElement('a'), { href, download: name }).click()
  setTimeout(() => URL.revokeObjectURL(href), KEPT_MS) // the browser may still be reading it
}

/** Save the drawing as a project file among the browser's downloads. */
export async function saveProject({ store, captures, clips }: Studio): Promise<void> {
  const { sheets, name, settings, seed, leaf, fruit } = store.state
  if (!sheets) return
  const { source, front, side } = sheets
  const sizes = { ...(source === 'sketch' && { front }), ...(side && { side }) }
  const clip = source === 'clip' ? await clips.file() : null
  const photos = source === 'capture' ? await captures.files() : null
  const pictures = { photo: front.file, ...(photos && { photos }), ...(clip && { clip }) }
  const project = { ...pictures, strokes: store.strokes, sizes, settings, seed, leaf, fruit }
  const file = projectName(name)
  saveFile(await writeProject(project), file)
  store.notify({ text: text.header.saved(file) })
}
