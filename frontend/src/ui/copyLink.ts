import type { Store } from '../state'
import { text } from '../text'
import { button, el, icon } from './dom'
import { wordsOf } from './downloads'
import { ICONS } from './icons'
import { announce } from './live'
import { copyText } from './saving'

const SHOWN_MS = 2500

/** Make the entry that copies a link to the model, or shows it where the browser does not let it be copied. */
export function linkItem(store: Store): HTMLElement {
  const words = wordsOf(text.files.link)
  const label = words.firstElementChild!
  const field = el('input', { class: 'link-field', readonly: true, 'aria-label': text.files.copyYourself })
  const refused = el('div', { class: 'link-refused', hidden: true }, el('p', {}, text.files.copyYourself), field)
  const copy = async () => {
    const copied = await copyText(field.value)
    refused.hidden = copied
    if (!copied) {
      field.focus()
      return field.select()
    }
    label.textContent = text.files.copied
    announce(text.files.copied)
    setTimeout(() => {
      label.textContent = text.files.link[0]
    }, SHOWN_MS)
  }
  const item = el(
    'div',
    {},
    button({ class: 'taking' }, () => void copy(), icon(ICONS.link), words),
    refused,
  )
  store.watch(
    state => state.model?.id ?? null,
    id => {
      item.hidden = id === null
      refused.hidden = true
      field.value = `${location.origin}/#${id}`
    },
  )
  return item
}
