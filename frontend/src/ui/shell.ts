import type { Studio } from '../studio/studio'
import { text } from '../text'
import { el } from './dom'
import { header } from './header'
import './shell.css'

/** Put the head and the empty main part into the page; gives the main part. */
export function mountShell(studio: Studio): HTMLElement {
  const main = el('main', { id: 'main', tabindex: -1 })
  const skip = el('a', { class: 'skip', href: '#main' }, text.header.skip)
  skip.addEventListener('click', event => {
    event.preventDefault() // the address names the model
    ;(main.querySelector<HTMLElement>('.workspace:not([hidden]) .canvas > *') ?? main).focus()
  })
  document.body.prepend(skip, header(studio), main)
  studio.store.watch(
    state => state.photo === null,
    closed => document.documentElement.classList.toggle('is-drawing', !closed),
  )
  return main
}
