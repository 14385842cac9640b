import { createContext } from 'preact'
import { useContext, useLayoutEffect, useReducer, useRef } from 'preact/hooks'
import type { State } from '../../state'
import type { Studio } from '../../studio/studio'

const StudioContext = createContext<Studio | null>(null)

/** Gives the studio to every component beneath it. */
export const StudioProvider = StudioContext.Provider

/** Return the studio that the page was made with. */
export function useStudio(): Studio {
  return useContext(StudioContext)!
}

/** Return what `select` gives of the state; the component is drawn again whenever it gives something else. */
export function useStore<T>(select: (state: State) => T): T {
  const { store } = useStudio()
  const [, redraw] = useReducer((drawn: number) => drawn + 1, 0)
  const value = select(store.state)
  const latest = useRef({ select, value })
  latest.current = { select, value }
  useLayoutEffect(
    () =>
      store.watch(
        state => state,
        state => latest.current.select(state) !== latest.current.value && redraw(undefined),
      ),
    [store],
  )
  return value
}
