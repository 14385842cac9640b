import { text } from '../text'
import { button, el, icon } from './dom'
import { ICONS } from './icons'
import './sheetHead.css'

/** Make the head of a dialog or a panel: its title, by which it is named, and the cross that closes it. */
export function sheetHead(id: string, title: string, close: () => void): HTMLElement {
  const cross = button({ class: 'button square', 'aria-label': text.close }, close, icon(ICONS.cross))
  return el('header', { class: 'sheet-head' }, el('h2', { id }, title), cross)
}
