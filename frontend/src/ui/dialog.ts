import { text } from '../text'
import { button, el, icon } from './dom'
import { ICONS } from './icons'
import './dialog.css'

let made = 0

/** Show a modal dialog; Escape, its cross and a click beside it close it, and focus goes back to where it was. */
export function openDialog(title: string, ...content: readonly Node[]): HTMLDialogElement {
  const id = `dialog-${++made}`
  const dialog = el('dialog', { class: 'dialog', 'aria-labelledby': id })
  const cross = button({ class: 'button square', 'aria-label': text.close }, () => dialog.close(), icon(ICONS.cross))
  dialog.append(el('header', { class: 'dialog-head' }, el('h2', { id }, title), cross), ...content)
  dialog.addEventListener('click', event => event.target === dialog && dialog.close())
  dialog.addEventListener('close', () => dialog.remove())
  document.body.append(dialog)
  dialog.showModal()
  return dialog
}
