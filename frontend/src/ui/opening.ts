import type { Store } from '../state'
import { text } from '../text'
import { el } from './dom'
import { notify } from './notices'
import './opening.css'

/** Show that a photo is being read; where that fails while a drawing is open, say so in a notice. */
export function mountOpening(store: Store): void {
  const pill = el('div', { class: 'opening', role: 'status' })
  document.body.append(pill)
  store.watch(
    state => state.opening,
    opening => pill.replaceChildren(...(opening ? [el('span', { class: 'opening-leaf' }), text.welcome.reading] : [])),
  )
  let close = () => {}
  store.watch(
    state => (state.photo ? state.faults.photo : undefined),
    fault => {
      close()
      if (fault) close = notify(fault.text, { gone: () => store.fault('photo', null) })
    },
  )
}
