import { useLayoutEffect, useMemo, useRef, useState } from 'preact/hooks'
import { PhotoStrip } from '../capture/PhotoStrip'
import { tracksIn } from '../film/tracksIn'
import type { Filmed } from '../film/useFilm'
import { useWatching } from '../film/useWatching'
import { useStore, useStudio } from '../parts/useStore'
import { DrawingFoot, ZoomBar } from './DrawingFoot'
import { HintLine } from './HintLine'
import { Sheets } from './Sheets'
import { SheetSketches, type Views } from './sheetSketches'
import { listenToShortcuts } from './shortcuts'
import { Toolbar } from './Toolbar'

/** The sheets, the tools to draw on them, and the hint; of a clip, its frames and its video. */
export function DrawingPane({ filmed: { parts, film } }: { readonly filmed: Filmed }) {
  const studio = useStudio()
  const active = useStore(state => state.active)
  const tracks = useStore(tracksIn)
  const [watching, setWatching] = useWatching()
  const [peeks, peek] = useState(false)
  const [views, setViews] = useState<Views>({})
  const sketches = useMemo(
    () => new SheetSketches(studio, (name, view) => setViews(before => ({ ...before, [name]: view }))),
    [studio],
  )
  const turned = useRef(false)
  const turnToOther = () => {
    turned.current = Boolean(studio.store.state.sheets?.side)
    studio.sheets.activate(studio.store.state.active === 'front' ? 'side' : 'front')
  }
  // A small screen shows the other sheet only after this render: before, it cannot have the focus.
  useLayoutEffect(() => {
    if (turned.current) sketches.focus(active)
    turned.current = false
  }, [active])
  useLayoutEffect(() => listenToShortcuts(studio, sketches, turnToOther), [studio])
  return (
    <>
      <Toolbar />
      <HintLine />
      <div class="drawing-stage">
        <Sheets sketches={sketches} views={views} />
        <DrawingFoot />
        <ZoomBar zoom={sketches} scale={views[active]?.scale ?? 1} />
        {parts && film && (watching.isOn || peeks) && (
          <parts.ClipScreen film={film} tracks={watching.isOn && watching.hasTracks ? tracks : null} />
        )}
      </div>
      <PhotoStrip />
      {parts && <parts.FilmStrip watching={watching} set={setWatching} peek={peek} />}
    </>
  )
}
