import './ui/base.css'
import { Studio } from './studio/studio'
import { takeFiles } from './ui/intake'
import { mountLive } from './ui/live'
import { mountOpening } from './ui/opening'
import { warnUnkept } from './ui/projectFile'
import { followSession, resume } from './ui/session'
import { mountShell } from './ui/shell'
import { listenToShortcuts } from './ui/shortcuts'
import { followTitle } from './ui/title'
import { mountWelcome } from './ui/welcome'

const studio = new Studio()
const { store, client } = studio

const main = mountShell(studio)
mountLive()
mountOpening(store)
takeFiles(studio)
followTitle(store)
warnUnkept(studio)
client.getLimits().then(
  limits => store.set({ limits }),
  () => {}, // the service tells its limits again when one is passed
)

await resume(studio)
followSession(studio)
mountWelcome(studio, main)

// Drawing and 3D come after the first sight of the page.
const { mountWorkspace } = await import('./ui/workspace')
listenToShortcuts(studio, mountWorkspace(studio, main))
main.dataset.ready = 'true'
