import { el } from './dom'
import { sheetHead } from './sheetHead'
import './dialog.css'

let made = 0

/** Show a modal dialog; Escape, its cross and a click beside it close it, and focus goes back to where it was. */
export function openDialog(title: string, ...content: readonly Node[]): HTMLDialogElement {
  const id = `dialog-${++made}`
  const dialog = el('dialog', { class: 'dialog', 'aria-labelledby': id })
  const head = sheetHead(id, title, () => dialog.close())
  dialog.append(head, ...content)
  dialog.addEventListener('click', event => event.target === dialog && dialog.close())
  dialog.addEventListener('close', () => dialog.remove())
  document.body.append(dialog)
  dialog.showModal()
  return dialog
}
