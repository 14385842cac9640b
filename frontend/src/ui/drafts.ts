import type { Draft } from '../studio/draftStore'
import type { Studio } from '../studio/studio'
import { text } from '../text'
import { button, el, icon } from './dom'
import { drawnPair } from './drawn'
import { ICONS } from './icons'
import { mayLeave } from './intake'
import { notify } from './notices'
import { ago } from './when'

/** What is kept in this browser, as a shelf of cards; `show` reads it anew. */
export function draftCards(studio: Studio): { section: HTMLElement; show(): Promise<void> } {
  const cards = el('ul', { class: 'picks small' })
  const head = el(
    'div',
    { class: 'shelf-head' },
    el('h2', { id: 'drafts' }, text.welcome.drafts),
    el('p', { class: 'soft' }, text.welcome.draftsHint),
  )
  const section = el('section', { class: 'shelf', 'aria-labelledby': 'drafts', hidden: true }, head, cards)
  const show = async () => {
    const drafts = await studio.keeper.list().catch(() => [])
    cards.replaceChildren(...drafts.map(draft => card(draft, studio, show)))
    section.hidden = drafts.length === 0
  }
  return { section, show }
}

function card(draft: Draft, studio: Studio, changed: () => Promise<void>): HTMLElement {
  const name = draft.name || text.header.untitled
  const frame = el('span', { class: 'pick-photo' })
  const open = button({ class: 'pick' }, () => mayLeave(studio) && void studio.opener.openDraft(draft.id))
  const when = el('span', { class: 'pick-when' }, ago(draft.saved))
  open.append(frame, el('span', { class: 'pick-name' }, name), when)
  const remove = button(
    { class: 'button square pick-remove' },
    () => void removeDraft(draft, studio, changed),
    icon(ICONS.remove),
  )
  remove.title = text.welcome.deleteDraft(name)
  remove.ariaLabel = remove.title
  void picture(draft.id, frame, studio)
  return el('li', {}, open, remove)
}

async function picture(id: string, frame: HTMLElement, { keeper }: Studio): Promise<void> {
  const found = await keeper.find(id).catch(() => null)
  if (!found) return
  const { photo: file, draft } = found
  if (!file) {
    frame.classList.add('on-paper')
    frame.append(drawnPair(draft.photo, draft.history.present, draft.side ?? null))
    return
  }
  const url = URL.createObjectURL(file)
  const photo = el('img', { src: url, alt: '' })
  photo.onload = () => URL.revokeObjectURL(url)
  frame.append(photo)
}

async function removeDraft({ id, name }: Draft, { keeper }: Studio, changed: () => Promise<void>): Promise<void> {
  const found = await keeper.find(id)
  await keeper.remove(id)
  await changed()
  const restore = async () => {
    if (found) await keeper.restore(found)
    await changed()
  }
  const action = { label: text.welcome.undo, run: () => void restore() }
  notify(text.welcome.draftDeleted(name || text.header.untitled), { action })
}
