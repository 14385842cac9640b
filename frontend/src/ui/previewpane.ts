import { NOTHING_SHOWN, Preview, type PreviewStatus } from '../preview/preview'
import type { State, Store } from '../state'
import type { Studio } from '../studio/studio'
import { text } from '../text'
import { el } from './dom'
import { followState } from './follow'
import { growBar } from './growbar'
import { heraldGrowth } from './herald'
import { announce } from './live'
import { previewBar, showsSwitch } from './previewbar'
import { sapling } from './sapling'
import { settingsPanel } from './settings'
import { variantChoice } from './variantChoice'
import { windSwitch } from './windSwitch'
import './previewpane.css'

/** The service's code for a depth that was guessed. */
const ASSUMED = 'side_assumed'

/** Put the tree's side of the page into `host`: the preview with its buttons, and the bar that has it grown. */
export function mountPreviewPane(studio: Studio, host: HTMLElement): Preview {
  const { store } = studio
  const scene = el('div', { class: 'scene' })
  const settings = settingsPanel(studio)
  const bar = previewBar(store, () => preview)
  const wind = windSwitch(
    () => preview,
    () => settings.open('file'),
  )
  const aside = beside(studio)
  const below = el(
    'div',
    { class: 'afoot' },
    assumption(store),
    showsSwitch(store),
    variantChoice(studio),
    wind.element,
  )
  const stage = el('div', { class: 'stage' }, scene, aside.element, ...bar.elements, below)
  host.append(el('div', { class: 'previewpane' }, stage, growBar(studio, settings, picture)))
  let status = NOTHING_SHOWN
  const parts = [bar, wind, aside]
  for (const part of parts) part.show(status)
  const preview = new Preview(scene, {
    labels: { wipe: text.preview.wipe, canvas: text.preview.canvas },
    reducedMotion: () => matchMedia('(prefers-reduced-motion: reduce)').matches,
    onStatus: now => {
      status = now
      for (const part of parts) part.show(now)
    },
  })
  followState(store, preview)
  heraldGrowth(store, announce)
  return preview

  async function picture(): Promise<Blob> {
    const sheet = store.state.model?.files['preview.png']
    return status.webgl === 'absent' && sheet ? studio.client.getFile(sheet) : preview.png()
  }
}

/** Make the note of what was assumed where only one side was drawn. */
function assumption(store: Store): HTMLElement {
  const note = el('p', { class: 'afloat assumed', role: 'status' })
  store.watch(isAssumed, assumed => {
    note.hidden = !assumed
    note.textContent = assumed ? text.sheets.assumed : ''
  })
  return note
}

function isAssumed({ source, traced, grown }: State): boolean {
  return (
    source === 'sketch' && grown !== null && (traced?.answer.warnings.some(({ code }) => code === ASSUMED) ?? false)
  )
}

/** Make what stands in the preview's place, or over it: an invitation, a picture where there is no 3D, what is wrong. */
function beside({ store }: Studio) {
  const invitation = el('div', { class: 'invitation' }, sapling(), el('p', {}, text.preview.empty))
  const sheet = el('img', { class: 'sheet', alt: text.preview.picture })
  const notice = el('p', { class: 'stage-notice' })
  let webgl: PreviewStatus['webgl'] = 'ok'
  let isEmpty = true
  const show = (state: State) => {
    const absent = webgl === 'absent'
    const url = state.tree ? state.model?.files['preview.png'] : undefined
    sheet.hidden = !absent || !url
    if (url && absent && sheet.getAttribute('src') !== url) sheet.src = url
    invitation.hidden = absent ? !sheet.hidden : !isEmpty
    notice.textContent = state.faults.preview?.text ?? troubleOf(webgl)
    notice.hidden = notice.textContent === ''
    notice.classList.toggle('fault', Boolean(state.faults.preview))
  }
  store.watch(state => state, show)
  const element = el('div', { class: 'beside' }, invitation, sheet, notice)
  return {
    element,
    show: (now: PreviewStatus) => {
      webgl = now.webgl
      isEmpty = now.shows === 'empty'
      show(store.state)
    },
  }
}

function troubleOf(webgl: PreviewStatus['webgl']): string {
  if (webgl === 'absent') return text.preview.absent
  return webgl === 'lost' ? text.preview.lost : ''
}
