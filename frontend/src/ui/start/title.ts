import { isFinished } from '../../api/follow'
import type { State, Store } from '../../state'
import { text } from '../../text'

/** Keep the tab's title at what is open and how far it has grown. */
export function followTitle(store: Store): void {
  store.watch(titleOf, title => {
    document.title = title
  })
}

/** Return the tab's title. */
export function titleOf({ sheets, name, asking, model }: Pick<State, 'sheets' | 'name' | 'asking' | 'model'>): string {
  if (!sheets) return text.app
  const named = name || text.header.untitled
  const growing = asking || (model !== null && !isFinished(model.info))
  const progress = asking ? 0 : (model?.info.progress ?? 0)
  return growing ? text.header.growing(Math.floor(progress * 100) / 100, named) : text.header.title(named)
}
