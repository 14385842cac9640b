import { el } from './dom'

const polite = el('div', { class: 'unseen', role: 'status', 'aria-live': 'polite' })

/** Put the live region into the page. */
export function mountLive(): void {
  document.body.append(polite)
}

/** Have screen readers say a sentence. */
export function announce(sentence: string): void {
  polite.textContent = sentence
}
