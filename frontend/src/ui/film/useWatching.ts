import { useLayoutEffect, useState } from 'preact/hooks'
import { clipOf } from '../../sheets'
import { useStore, useStudio } from '../parts/useStore'
import type { Watching } from './FilmStrip'

/** Return whether the video is watched, and how to set it: it is once a tree is grown, until something is drawn. */
export function useWatching(): [Watching, (watching: Watching) => void] {
  const { playhead } = useStudio()
  const [watching, set] = useState<Watching>({ isOn: false, hasTracks: true })
  const clip = useStore(state => clipOf(state)?.id ?? null)
  const isGrown = useStore(({ model, shows }) => Boolean(model?.glb) && shows === 'model')
  const tool = useStore(state => state.tool)
  const choose = (next: Watching) => {
    set(next)
    if (next.isOn === watching.isOn || playhead.hasTree) return // what a tree plays goes on
    if (next.isOn) playhead.play()
    else playhead.pause()
  }
  useLayoutEffect(() => choose({ ...watching, isOn: clip !== null && isGrown }), [clip, isGrown])
  useLayoutEffect(() => choose({ ...watching, isOn: false }), [tool])
  return [watching, choose]
}
