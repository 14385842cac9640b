import type { Preview, PreviewStatus } from '../preview/preview'
import { text } from '../text'
import { button, el, icon } from './dom'
import { ICONS } from './icons'
import { spoken } from './settingGroups'

const STILL = 'still'

/** The wind's buttons over the preview; `show` brings them into step with it. */
export interface WindSwitch {
  readonly element: HTMLElement
  show(status: PreviewStatus): void
}

/** Make the choice between stillness and the winds of the file; where it has none, the way to where they are chosen. */
export function windSwitch(preview: () => Preview, toSettings: () => void): WindSwitch {
  const { wind: words } = text.preview
  const winds = el('div', { class: 'afloat winds', role: 'group', 'aria-label': words.group })
  const none = button(
    { class: 'button', title: words.noneWhy },
    toSettings,
    icon(ICONS.wind),
    el('span', { class: 'roomy' }, words.none),
  )
  none.ariaLabel = words.none
  // Where there is no room for buttons.
  const list = el('select', { class: 'afloat wind-choice', 'aria-label': words.group })
  list.addEventListener('change', () => blow(list.value))
  const hint = el('div', { class: 'afloat no-wind' }, none)
  let known = ''
  return {
    element: el('div', { class: 'wind' }, winds, list, hint),
    show: ({ winds: names, wind, shows, webgl }) => {
      const isTree = shows === 'model' && webgl !== 'absent'
      winds.hidden = list.hidden = !isTree || names.length === 0
      hint.hidden = !isTree || names.length > 0
      if (known !== names.join()) {
        known = names.join()
        const all = [STILL, ...names]
        winds.replaceChildren(icon(ICONS.wind), ...all.map(choice))
        list.replaceChildren(...all.map(value => el('option', { value }, nameOf(value))))
      }
      list.value = wind ?? STILL
      for (const one of winds.querySelectorAll('button'))
        one.setAttribute('aria-pressed', String(one.dataset.wind === (wind ?? STILL)))
    },
  }

  function blow(name: string): void {
    preview().blow(name === STILL ? null : name)
  }

  function choice(name: string): HTMLElement {
    return button({ class: 'button', 'data-wind': name }, () => blow(name), nameOf(name))
  }
}

function nameOf(wind: string): string {
  return text.preview.wind.names[wind] ?? spoken(wind)
}
