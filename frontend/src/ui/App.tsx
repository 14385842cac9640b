import type { ComponentType, TargetedMouseEvent } from 'preact'
import { useEffect, useLayoutEffect, useRef, useState } from 'preact/hooks'
import { isAccountTab } from '../access'
import type { Studio } from '../studio/studio'
import { text } from '../text'
import { AccountTabs, SignIn } from './account/Account'
import { StudioProvider, useStore, useStudio } from './parts/useStore'
import { DropArea } from './start/DropArea'
import { Header } from './start/Header'
import { Notices } from './start/Notices'
import { followSession, hasSession, resume } from './start/session'
import { Welcome } from './start/Welcome'
import './app.css'
import './start/opening.css'

/** The whole page. */
export function App({ studio }: { readonly studio: Studio }) {
  return (
    <StudioProvider value={studio}>
      <Page />
      <Opening />
      <DropArea />
      <LiveRegion />
      <Overlaid />
      <SignIn />
    </StudioProvider>
  )
}

/** The head, and the welcome or the drawing. */
function Page() {
  const main = useRef<HTMLElement>(null)
  const closed = useStore(({ sheets }) => sheets === null)
  const { resuming, Workspace, ready } = useStart(closed)
  useLayoutEffect(() => {
    document.documentElement.classList.toggle('is-drawing', !closed)
  }, [closed])
  const skip = (event: TargetedMouseEvent<HTMLAnchorElement>) => {
    event.preventDefault() // the address names the model
    const sketch = main.current!.querySelector<HTMLElement>('.workspace:not([hidden]) .canvas > *')
    ;(sketch ?? main.current!).focus()
  }
  return (
    <>
      {/* biome-ignore lint/a11y/useValidAnchor: it goes to a part of the page */}
      <a class="skip" href="#main" onClick={skip}>
        {text.header.skip}
      </a>
      <Header />
      <main id="main" tabIndex={-1} ref={main} data-ready={ready ? 'true' : undefined}>
        <Welcome late={resuming} />
        {Workspace && <Workspace />}
      </main>
    </>
  )
}

/** Open again what was open and load the workspace, both after the first paint; the page is ready when both are there. */
function useStart(closed: boolean) {
  const studio = useStudio()
  const [resuming, setResuming] = useState(hasSession)
  const [Workspace, setWorkspace] = useState<ComponentType | null>(null)
  const [ready, setReady] = useState(false)
  useEffect(() => {
    const resumed = resume(studio).then(() => {
      followSession(studio)
      setResuming(false)
    })
    const loaded = import('./drawing/Workspace').then(module => setWorkspace(() => module.Workspace))
    void Promise.all([resumed, loaded]).then(() => setReady(true))
  }, [studio])
  return { resuming, Workspace: resuming && closed ? null : Workspace, ready }
}

/** Says that a photo, a sketch or a project is being read. */
function Opening() {
  const opening = useStore(state => state.opening)
  return (
    <div class="opening" role="status">
      {opening && (
        <>
          <span class="opening-leaf" />
          {text.welcome.opening}
        </>
      )}
    </div>
  )
}

/** What screen readers say. */
function LiveRegion() {
  const announcement = useStore(state => state.announcement)
  return (
    <div class="visually-hidden" role="status" aria-live="polite">
      {announcement}
    </div>
  )
}

/** The open dialog, loaded before the first is opened; it lies over everything else, so notices are shown within it. */
function Overlaid() {
  const dialog = useStore(state => state.dialog)
  const [Dialogs, setDialogs] = useState<ComponentType | null>(null)
  useEffect(() => {
    void import('./start/Dialogs').then(module => setDialogs(() => module.Dialogs))
  }, [])
  if (isAccountTab(dialog)) return <AccountTabs />
  return dialog && Dialogs ? <Dialogs /> : <Notices />
}
