import type { Studio } from '../studio/studio'
import { text } from '../text'
import { button, el, icon, svg } from './dom'
import { openGallery } from './gallery'
import { ICONS } from './icons'
import { choose, mayLeave } from './intake'
import { popover } from './popover'
import { saveProject } from './projectFile'
import { withCtrl } from './shortcutKeys'
import { openShortcuts } from './shortcutSheet'
import './header.css'

/** Make the page's head: home, the drawing's name, and what can be done with the drawing as a whole. */
export function header(studio: Studio): HTMLElement {
  const more = button({ class: 'button square head-more', 'aria-label': text.header.menu }, () => {}, icon(ICONS.more))
  const menu = popover(more, ...actions(studio))
  menu.classList.add('head-menu')
  menu.addEventListener('click', () => menu.matches(':popover-open') && menu.hidePopover())
  const head = el(
    'header',
    { class: 'head' },
    el('div', { class: 'head-row' }, wordmark(studio), nameField(studio), menu, more),
  )
  studio.store.watch(
    state => state.photo === null,
    closed => head.classList.toggle('is-closed', closed),
  )
  return head
}

function wordmark(studio: Studio): HTMLElement {
  const home = button(
    { class: 'button wordmark', title: text.header.home },
    () => mayLeave(studio) && studio.opener.close(),
  )
  home.append(mark(), el('span', {}, text.app))
  return home
}

/** The two strokes: the crown's and the trunk's. */
function mark(): SVGElement {
  const crown = 'M13.5 3.8C8 4.5 4.5 8.3 4.5 12.9c0 5 4.7 8.6 11.5 8.6s11.5-3.6 11.5-8.6c0-5.2-4.6-9.2-10.5-9.4'
  return svg(
    'svg',
    { viewBox: '0 0 32 32', class: 'mark', 'aria-hidden': 'true' },
    svg('path', { class: 'mark-crown', d: crown }),
    svg('path', { class: 'mark-trunk', d: 'M16 29V11.5M16 20l4.8-4.8M16 17l-4-4' }),
  )
}

function nameField({ store }: Studio): HTMLElement {
  const input = el('input', { class: 'head-name', 'aria-label': text.header.name, placeholder: text.header.untitled })
  const title = el('h1', { class: 'unseen' })
  const show = (name: string) => {
    input.value = name
    title.textContent = name || text.header.untitled
  }
  input.spellcheck = false
  input.addEventListener('change', () => store.set({ name: input.value.trim() }))
  input.addEventListener('keydown', event => {
    if (event.key === 'Escape') show(store.state.name)
    if (event.key === 'Enter' || event.key === 'Escape') input.blur()
  })
  store.watch(state => state.name, show)
  store.watch(
    state => state.limits?.name_length,
    length => length && input.setAttribute('maxlength', String(length)),
  )
  return el('div', { class: 'head-title' }, title, input)
}

function actions(studio: Studio): HTMLElement[] {
  const action = (label: string, path: string, act: () => void, key = '') =>
    button({ class: 'button', title: key ? text.tools.withKey(label, key) : label }, act, icon(path), label)
  const own = [
    action(text.header.newPhoto, ICONS.photo, () => choose(studio, 'photo')),
    action(text.header.open, ICONS.open, () => choose(studio), withCtrl('O')),
    action(text.header.save, ICONS.save, () => void saveProject(studio), withCtrl('S')),
  ]
  for (const one of own) one.classList.add('of-drawing')
  return [
    ...own,
    action(text.header.gallery, ICONS.gallery, () => openGallery(studio)),
    action(text.header.shortcuts, ICONS.keys, openShortcuts, '?'),
  ]
}
