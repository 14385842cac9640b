import { isOver } from '../api/follow'
import type { Model } from '../api/types'
import { Gallery } from '../studio/gallery'
import type { Studio } from '../studio/studio'
import { text } from '../text'
import { makeCard, nameOf } from './card'
import { openDialog } from './dialog'
import { button, el } from './dom'
import { announce } from './live'
import { sapling } from './sapling'
import './gallery.css'

const LOOK_MS = 2000
const LONGEST_NAME = 200

/** Show one's trees: to open, rename, download and delete. */
export function openGallery(studio: Studio): void {
  studio.store.fault('gallery', null)
  const view = new GalleryView(studio)
  const dialog = openDialog(text.gallery.title, view.element)
  dialog.classList.add('gallery-dialog')
  dialog.addEventListener('close', () => view.leave())
  view.close = () => dialog.close()
  void view.load()
}

class GalleryView {
  close = () => {}
  readonly #gallery: Gallery
  readonly #list = el('ul', { class: 'cards' })
  readonly #loading = el('p', { class: 'gallery-loading', role: 'status' }, text.gallery.loading)
  readonly #empty = el('p', { class: 'gallery-empty', hidden: true }, sapling(), text.gallery.empty)
  readonly #wrong = el('p', { role: 'alert' })
  readonly #again = button({ class: 'button outlined' }, () => void this.load(), text.gallery.again)
  readonly #more = button(
    { class: 'button outlined gallery-more', hidden: true },
    () => void this.load(),
    text.gallery.more,
  )
  readonly #fault = el('div', { class: 'fault gallery-fault' }, this.#wrong, this.#again)
  readonly element = el('div', { class: 'gallery' }, this.#fault, this.#list, this.#empty, this.#loading, this.#more)
  readonly #unwatch: () => void
  /** The models under way and their cards. */
  readonly #moving = new Map<Model, HTMLElement>()
  #looking: ReturnType<typeof setTimeout> | undefined
  #loaded = false

  constructor(private readonly studio: Studio) {
    this.#gallery = new Gallery(studio.store, studio.client, studio.grower)
    this.#unwatch = studio.store.watch(
      state => state.faults.gallery,
      fault => {
        this.#fault.hidden = !fault
        this.#wrong.textContent = fault?.text ?? ''
        this.#again.hidden = this.#loaded
      },
    )
  }

  /** Bring the next page. */
  async load(): Promise<void> {
    this.#loading.hidden = false
    this.#loaded = false
    const held = [this.#more, this.#again].some(button => button === document.activeElement)
    const models = await this.#gallery.more()
    this.#loaded = models !== null
    this.#loading.hidden = true
    const cards = (models ?? []).map(model => this.#card(model))
    this.#list.append(...cards)
    this.#more.hidden = !this.#gallery.hasMore
    this.#empty.hidden = !this.#loaded || this.#list.childElementCount > 0
    if (held && models) (cards[0] ?? this.element.closest('dialog'))?.querySelector('button')?.focus()
    this.#lookLater()
  }

  /** Look no more. */
  leave(): void {
    clearTimeout(this.#looking)
    this.#unwatch()
    this.#moving.clear()
  }

  #card(model: Model): HTMLElement {
    const longest = this.studio.store.state.limits?.name_length ?? LONGEST_NAME
    const actions = {
      open: () => {
        this.close()
        void this.studio.opener.openModel(model.id)
      },
      rename: async (name: string) => {
        const renamed = await this.#gallery.rename(model.id, name)
        if (renamed) this.#replace(card, this.#card(renamed))
        return renamed
      },
      remove: () => void this.#remove(model, card),
    }
    const card = makeCard(model, actions, longest)
    if (!isOver(model)) this.#moving.set(model, card)
    return card
  }

  async #remove(model: Model, card: HTMLElement): Promise<void> {
    if (!(await this.#gallery.remove(model.id))) return
    this.#moving.delete(model)
    const said = text.gallery.removed(nameOf(model))
    const undo = button({ class: 'button outlined' }, () => void this.#restore(model, gone), text.gallery.undo)
    const gone = el('li', { class: 'card gone' }, el('p', {}, said), undo)
    card.replaceWith(gone)
    undo.focus()
    announce(said)
  }

  async #restore(model: Model, gone: HTMLElement): Promise<void> {
    const restored = await this.#gallery.restore(model.id)
    if (!restored) return
    const card = this.#card(restored)
    gone.replaceWith(card)
    card.querySelector('button')?.focus()
    announce(text.gallery.restored(nameOf(model)))
  }

  /** Put a card in another's place; a button that had the focus keeps it. */
  #replace(old: HTMLElement, card: HTMLElement): void {
    const place = [...old.querySelectorAll<HTMLElement>('button, a')].indexOf(document.activeElement as HTMLElement)
    old.replaceWith(card)
    if (place >= 0) card.querySelectorAll<HTMLElement>('button, a')[place]?.focus()
  }

  #lookLater(): void {
    clearTimeout(this.#looking)
    if (this.#moving.size) this.#looking = setTimeout(() => void this.#look(), LOOK_MS)
  }

  /** See how the models under way are now. */
  async #look(): Promise<void> {
    for (const [model, card] of [...this.#moving]) {
      const now = await this.#gallery.look(model)
      if (!now || !this.#moving.delete(model) || card.querySelector('input')) continue
      this.#replace(card, this.#card(now))
    }
    this.#lookLater()
  }
}
