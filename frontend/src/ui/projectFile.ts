import { projectName, writeProject } from '../studio/project'
import type { Studio } from '../studio/studio'
import { text } from '../text'
import { notify } from './notices'

/** Save the drawing as a project file among the browser's downloads. */
export async function saveProject({ store }: Studio): Promise<void> {
  const { photo, name, settings, seed } = store.state
  if (!photo) return
  const file = projectName(name)
  offer(await writeProject({ photo: photo.file, strokes: store.strokes, settings, seed }), file)
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

function offer(file: Blob, name: string): void {
  const link = document.createElement('a')
  link.href = URL.createObjectURL(file)
  link.download = name
  link.click()
  setTimeout(() => URL.revokeObjectURL(link.href), 60_000)
}
