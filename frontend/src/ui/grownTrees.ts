import type { Model } from '../api/types'
import type { Studio } from '../studio/studio'
import { text } from '../text'
import { button, el, icon } from './dom'
import { openGallery } from './gallery'
import { ICONS } from './icons'

const SHOWN = 4

/** The way to the gallery, with the latest trees of it; there is none before the first tree. */
export function grownTrees(studio: Studio): { section: HTMLElement; show(): Promise<void> } {
  const pictures = el('span', { class: 'grown-pictures' })
  const open = button(
    { class: 'button outlined grown' },
    () => openGallery(studio),
    icon(ICONS.gallery),
    text.welcome.grown,
    pictures,
  )
  const section = el('div', { class: 'shelf grown-shelf', hidden: true }, open)
  const show = async () => {
    const page = await studio.client.listModels(null).catch(() => null)
    const models = page?.models ?? []
    pictures.replaceChildren(...models.flatMap(picture).slice(0, SHOWN))
    section.hidden = models.length === 0
  }
  return { section, show }
}

function picture({ files }: Model): HTMLElement[] {
  const url = files['preview.png']
  return url ? [el('img', { src: url, alt: '' })] : []
}
