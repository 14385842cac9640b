import type { Notice, State } from '../../state'
import type { Studio } from '../../studio/studio'
import { text } from '../../text'
import { saveProject } from '../parts/saving'

/** Show a notice while the browser cannot keep the drawing that is open. */
export function warnUnkept(studio: Studio): void {
  const action = { label: text.header.save, run: () => void saveProject(studio) }
  noticeWhile(
    studio,
    state => !state.kept && state.sheets !== null,
    unkept => (unkept ? { text: text.hints.unkept, action, stays: true } : null),
  )
}

/** Show a notice where a file cannot be opened while a drawing is open: the welcome, which says it, is hidden then. */
export function warnUnopened(studio: Studio): void {
  noticeWhile(
    studio,
    state => (state.sheets ? state.faults.photo : undefined),
    fault => (fault ? { text: fault.text, gone: () => studio.store.fault('photo', null) } : null),
  )
}

/** Show the notice that goes with what `select` gives, until that changes. */
function noticeWhile<T>({ store }: Studio, select: (state: State) => T, noticeOf: (value: T) => Notice | null): void {
  let close = () => {}
  store.watch(select, value => {
    close()
    const notice = noticeOf(value)
    if (notice) close = store.notify(notice)
  })
}
