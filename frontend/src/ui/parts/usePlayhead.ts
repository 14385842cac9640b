import { useEffect, useReducer } from 'preact/hooks'
import type { Playhead } from '../../playhead'

/** Draw the component again when the playhead is changed, and in every frame while it plays. */
export function usePlayhead(playhead: Playhead): void {
  const [, redraw] = useReducer((drawn: number) => drawn + 1, 0)
  useEffect(() => followPlayhead(playhead, () => redraw(undefined)), [playhead])
}

/** Call `show` now, when the playhead is changed, and in every frame while it plays; returns a function that ends this. */
export function followPlayhead(playhead: Playhead, show: () => void): () => void {
  let pending = 0
  const step = () => {
    pending = 0
    show()
    if (playhead.playing) ask()
  }
  const ask = () => {
    pending ||= requestAnimationFrame(step)
  }
  const end = playhead.watch(ask)
  ask()
  return () => {
    end()
    cancelAnimationFrame(pending)
  }
}
