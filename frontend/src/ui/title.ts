import { isOver } from '../api/follow'
import type { State, Store } from '../state'
import { text } from '../text'

/** Keep the tab's title at what is open and how far it has grown. */
export function followTitle(store: Store): void {
  store.watch(titleOf, title => {
    document.title = title
  })
}

/** Say what the tab's title is. */
export function titleOf({ photo, name, asking, model }: State): string {
  if (!photo) return text.app
  const named = name || text.header.untitled
  const growing = asking || (model !== null && !isOver(model))
  const progress = asking ? 0 : (model?.progress ?? 0)
  return growing ? text.header.growing(Math.floor(progress * 100), named) : text.header.title(named)
}
