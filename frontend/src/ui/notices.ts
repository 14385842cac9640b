import { text } from '../text'
import { button, el, icon } from './dom'
import { ICONS } from './icons'
import './notices.css'

interface NoticeOptions {
  /** What can be done about it. */
  readonly action?: { readonly label: string; run(): void }
  /** It is shown until it is closed. */
  readonly stays?: true
  /** Hears that it went. */
  gone?(): void
}

const SHOWN_MS = 9000
const region = el('div', { class: 'notices', role: 'status' })

/** Say something that has no place of its own; it goes by itself, unless it is pointed at. The call ends it. */
export function notify(sentence: string, { action, stays, gone }: NoticeOptions = {}): () => void {
  const notice = el('div', { class: 'notice' }, el('p', {}, sentence))
  const close = () => {
    if (!notice.isConnected) return
    notice.remove()
    gone?.()
  }
  const act = () => {
    close()
    action?.run()
  }
  if (action) notice.append(button({ class: 'button notice-action' }, act, action.label))
  notice.append(button({ class: 'button square', 'aria-label': text.notices.close }, close, icon(ICONS.cross)))
  place()
  region.append(notice)
  if (!stays) closeInTime(notice, close)
  return close
}

/** A dialog lies over everything else: what is said meanwhile is said within it. */
function place(): void {
  const dialog = [...document.querySelectorAll('dialog[open]')].at(-1)
  ;(dialog ?? document.body).append(region)
  dialog?.addEventListener('close', () => document.body.append(region), { once: true })
}

function closeInTime(notice: HTMLElement, close: () => void): void {
  let timer = setTimeout(close, SHOWN_MS)
  for (const held of ['pointerenter', 'focusin']) notice.addEventListener(held, () => clearTimeout(timer))
  for (const left of ['pointerleave', 'focusout']) {
    notice.addEventListener(left, () => {
      clearTimeout(timer)
      timer = setTimeout(close, SHOWN_MS)
    })
  }
}
