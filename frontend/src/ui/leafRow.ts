import type { Studio } from '../studio/studio'
import { text } from '../text'
import { button, el } from './dom'
import { announce } from './live'

/** Make the row in which a person's own leaf is chosen, seen, replaced and removed. */
export function leafRow({ store, herbarium }: Studio): HTMLElement {
  const words = text.settings.leaf
  const picture = el('img', { class: 'leaf-picture', alt: words.shown, hidden: true })
  const wrong = el('p', { class: 'setting-wrong', role: 'alert' })
  const pick = button({ class: 'button outlined', 'aria-describedby': 'setting-leaf-why' }, ask, words.choose)
  const remove = button({ class: 'button outlined' }, drop, words.remove)
  const entry = el('div', { class: 'setting-entry' }, picture, pick, remove)
  const why = el('p', { class: 'setting-why', id: 'setting-leaf-why' }, words.why)
  store.watch(
    state => state.leaf,
    leaf => {
      show(picture, leaf)
      remove.hidden = leaf === null
      pick.textContent = leaf ? words.replace : words.choose
    },
  )
  store.watch(
    state => state.faults.leaf,
    fault => {
      wrong.textContent = fault?.text ?? ''
    },
  )
  return el('div', { class: 'setting', role: 'group', 'aria-labelledby': 'setting-leaf' }, label(), entry, why, wrong)

  function label(): HTMLElement {
    return el('span', { class: 'setting-label', id: 'setting-leaf' }, words.label)
  }

  function ask(): void {
    const input = el('input', { type: 'file', accept: 'image/png' })
    input.addEventListener('change', () => input.files?.[0] && void take(input.files[0]))
    input.click()
  }

  async function take(file: File): Promise<void> {
    await herbarium.take(file)
    if (!store.state.faults.leaf) announce(words.taken)
  }

  function drop(): void {
    pick.focus()
    herbarium.drop()
    announce(words.removed)
  }
}

/** Show a picture, and let go of the one before. */
function show(picture: HTMLImageElement, leaf: Blob | null): void {
  if (picture.src) URL.revokeObjectURL(picture.src)
  picture.hidden = leaf === null
  if (leaf) picture.src = URL.createObjectURL(leaf)
  else picture.removeAttribute('src')
}
