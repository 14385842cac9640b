import type { Studio } from '../studio/studio'
import { text } from '../text'
import { button, el, icon } from './dom'
import { downloadsPanel, hasTakings, treeLink } from './downloads'
import { anotherButton, growButton } from './growButtons'
import { ICONS } from './icons'
import { type makePanel, opening } from './panel'
import { progressBar, standingLine } from './progress'
import { scorePanel } from './score'
import type { SettingsPanel } from './settings'
import './growbar.css'

const STANDING = 'standing'

/** Make the bar below the preview: where growing stands, Grow with its settings, and what can be taken away. */
export function growBar(
  studio: Studio,
  { panel: settings, open }: SettingsPanel,
  picture: () => Promise<Blob>,
): HTMLElement {
  const score = scorePanel(studio.store)
  const downloads = downloadsPanel(studio, { picture, moreFormats: () => open('file') })
  const grow = growButton(studio, STANDING)
  const line = standingLine(studio, { id: STANDING, score, grow })
  const more = opener(downloads, 'downloads-opener', text.files.more, icon(ICONS.download), icon(ICONS.down))
  studio.store.watch(hasTakings, yes => {
    more.hidden = !yes
  })
  const actions = el(
    'div',
    { class: 'grow-actions' },
    grow,
    anotherButton(studio),
    opener(settings, 'settings-opener', text.grow.settings, icon(ICONS.sliders)),
    treeLink(studio),
    more,
  )
  return el('div', { class: 'growbar' }, progressBar(studio), line, actions, settings, score, downloads)
}

function opener(
  panel: ReturnType<typeof makePanel>,
  name: string,
  label: string,
  ...drawings: SVGSVGElement[]
): HTMLElement {
  const words = el('span', { class: 'opener-words' }, label)
  return button({ class: `button outlined ${name}`, title: label, ...opening(panel) }, () => {}, ...drawings, words)
}
