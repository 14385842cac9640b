import { useEffect, useState } from 'preact/hooks'
import { clipOf } from '../../sheets'
import { useLoaded } from '../parts/useLoaded'
import { useStore, useStudio } from '../parts/useStore'
import type { Film } from './film'
import type * as Parts from './filmParts'

/** What shows the open clip. */
export interface Filmed {
  /** The parts of the page for a clip; null while they are loaded, and where there is none. */
  readonly parts: typeof Parts | null
  /** Shows its frames; null where the service lost it. */
  readonly film: Film | null
}

/** Return what shows the open clip. */
export function useFilm(): Filmed {
  const { playhead, clips, store } = useStudio()
  const hasClip = useStore(state => clipOf(state) !== null)
  const id = useStore(state => clipOf(state)?.id ?? null)
  const parts = useLoaded(async () => (hasClip ? import('./filmParts') : null), [hasClip])
  const [film, setFilm] = useState<Film | null>(null)
  useEffect(() => {
    const { sheets } = store.state
    if (!parts || id === null || sheets?.source !== 'clip') return
    const made = new parts.Film({ ...sheets.clip, id }, playhead, clips.fileOf(id))
    playhead.showFrame(sheets.front.frame)
    setFilm(made)
    return () => {
      made.end()
      setFilm(null)
    }
  }, [id, parts])
  return { parts, film }
}
