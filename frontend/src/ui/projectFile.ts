import { projectName, writeProject } from '../studio/project'
import type { Studio } from '../studio/studio'
import { text } from '../text'
import { notify } from './notices'
import { saveFile } from './saving'

/** Save the drawing as a project file among the browser's downloads. */
export async function saveProject({ store }: Studio): Promise<void> {
  const { source, photo, side, name, settings, seed, leaf, fruit } = store.state
  if (!photo) return
  const file = projectName(name)
  const sheets = { ...(source === 'sketch' && { front: photo }), ...(side && { side }) }
  const own = { photo: photo.file, strokes: store.strokes, sheets, settings, seed, leaf, fruit }
  saveFile(await writeProject(own), file)
  notify(text.header.saved(file))
}

/** Say so while the browser cannot keep the drawing that is open. */
export function warnUnkept(studio: Studio): void {
  let close = () => {}
  studio.store.watch(
    state => !state.kept && state.photo !== null,
    unkept => {
      close()
      const action = { label: text.header.save, run: () => void saveProject(studio) }
      if (unkept) close = notify(text.hints.unkept, { action, stays: true })
    },
  )
}
