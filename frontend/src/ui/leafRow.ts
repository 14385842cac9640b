import type { Specimen } from '../studio/ownPictures'
import type { Studio } from '../studio/studio'
import { text } from '../text'
import { button, el } from './dom'
import { announce } from './live'

/** Make the row in which a person's own picture of a leaf or a fruit is chosen, seen, replaced and removed. */
export function ownRow({ store, herbarium }: Studio, what: Specimen): HTMLElement {
  const words = { ...text.settings.leaf, ...(what === 'fruit' && text.sheets.fruit) }
  const id = `setting-${what}`
  const picture = el('img', { class: 'leaf-picture', alt: words.shown, hidden: true })
  const wrong = el('p', { class: 'setting-wrong', role: 'alert' })
  const pick = button({ class: 'button outlined', 'aria-describedby': `${id}-why` }, ask, words.choose)
  const remove = button({ class: 'button outlined' }, drop, words.remove)
  const entry = el('div', { class: 'setting-entry' }, picture, pick, remove)
  const why = el('p', { class: 'setting-why', id: `${id}-why` }, words.why)
  store.watch(
    state => state[what],
    leaf => {
      show(picture, leaf)
      remove.hidden = leaf === null
      pick.textContent = leaf ? words.replace : words.choose
    },
  )
  store.watch(
    state => state.faults[what],
    fault => {
      wrong.textContent = fault?.text ?? ''
    },
  )
  return el('div', { class: 'setting', role: 'group', 'aria-labelledby': id }, label(), entry, why, wrong)

  function label(): HTMLElement {
    return el('span', { class: 'setting-label', id }, words.label)
  }

  function ask(): void {
    const input = el('input', { type: 'file', accept: 'image/png' })
    input.addEventListener('change', () => input.files?.[0] && void take(input.files[0]))
    input.click()
  }

  async function take(file: File): Promise<void> {
    await herbarium.take(file, what)
    if (!store.state.faults[what]) announce(words.taken)
  }

  function drop(): void {
    pick.focus()
    herbarium.drop(what)
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
