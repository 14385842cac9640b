import type { Model } from '../api/types'
import { fileName } from '../studio/project'
import { text } from '../text'
import { button, el, icon } from './dom'
import { ICONS } from './icons'
import { drawPortrait } from './portrait'
import { ago } from './when'

/** What can be done with a model of the gallery. */
export interface CardActions {
  open(): void
  rename(name: string): Promise<Model | null>
  remove(): void
}

/** Name a model as the gallery does. */
export function nameOf(model: Model): string {
  return model.name || text.gallery.unnamed
}

/** Make a model's card: its picture, its name, when it was grown, and what can be done with it. */
export function makeCard(model: Model, actions: CardActions, longestName: number): HTMLElement {
  const name = nameOf(model)
  const when = el(
    'time',
    { datetime: model.created, title: new Date(model.created).toLocaleString('en') },
    ago(Date.parse(model.created)),
  )
  const heading = el('h3', { class: 'card-name' }, name)
  const picture = button(
    { class: 'card-picture', 'aria-label': text.gallery.open(name) },
    actions.open,
    pictureOf(model),
  )
  const rename = tool(text.gallery.rename(name), ICONS.pencil, () =>
    editName(heading, rename, model, actions, longestName),
  )
  const tools = el(
    'div',
    { class: 'card-tools' },
    rename,
    downloadOf(model),
    tool(text.gallery.remove(name), ICONS.remove, actions.remove),
  )
  return el('li', { class: 'card' }, picture, heading, el('div', { class: 'card-foot' }, when, tools))
}

function pictureOf(model: Model): HTMLElement {
  const url = model.files['preview.png']
  if (!url) return el('span', { class: 'card-status' }, icon(ICONS.tree), statusOf(model))
  const canvas = el('canvas', { class: 'card-portrait', 'aria-hidden': 'true' })
  void drawPortrait(canvas, url).catch(() => canvas.replaceWith(icon(ICONS.tree)))
  return canvas
}

function statusOf({ status, progress }: Model): string {
  if (status === 'succeeded') return ''
  const said = text.gallery.status[status]
  return status === 'running' ? `${said} · ${text.progress.percent(Math.floor(progress * 100))}` : said
}

function downloadOf(model: Model): HTMLElement | null {
  const href = model.files['tree.glb']
  const label = text.gallery.download(nameOf(model))
  return href
    ? el(
        'a',
        { class: 'button square', href, download: fileName(model.name, '.glb'), 'aria-label': label, title: label },
        icon(ICONS.download),
      )
    : null
}

/** Put a field in the place of the name; Enter and leaving it keep what is written, Escape does not. */
function editName(
  heading: HTMLElement,
  back: HTMLElement,
  model: Model,
  { rename }: CardActions,
  longest: number,
): void {
  const field = el('input', {
    class: 'card-field',
    value: model.name,
    maxlength: longest,
    'aria-label': text.gallery.name,
  })
  let over = false
  const end = async (keep: boolean, refocus: boolean) => {
    if (over) return
    over = true
    field.replaceWith(heading)
    if (refocus) back.focus()
    if (keep && field.value.trim() !== model.name) await rename(field.value.trim())
  }
  field.addEventListener('blur', () => void end(true, false))
  field.addEventListener('keydown', event => {
    if (event.key !== 'Enter' && event.key !== 'Escape') return
    event.preventDefault() // Escape would close the gallery
    void end(event.key === 'Enter', true)
  })
  heading.replaceWith(field)
  field.focus()
  field.select()
}

function tool(label: string, drawing: string, use: () => void): HTMLButtonElement {
  return button({ class: 'button square', 'aria-label': label, title: label }, use, icon(drawing))
}
