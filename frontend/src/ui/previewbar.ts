import type { Preview, PreviewStatus, View } from '../preview/preview'
import type { Store } from '../state'
import { text } from '../text'
import { button, el, icon } from './dom'
import { ICONS } from './icons'

const VIEWS: readonly View[] = ['photo', 'front', 'side', 'back', 'top']
const STEP = 1.25

/** The buttons over the preview; `show` brings them into step with it. */
export interface PreviewBar {
  readonly elements: readonly HTMLElement[]
  show(status: PreviewStatus): void
}

/** Make the buttons that turn the tree to its views, take its leaves off and come nearer; hidden while there is none. */
export function previewBar(store: Store, preview: () => Preview): PreviewBar {
  const views = VIEWS.map(name =>
    button({ class: 'button', 'aria-pressed': 'false' }, () => preview().view(name), text.preview.view[name]),
  )
  nameFirst(store, views[0]!)
  let leafy = true
  const leaves = tool(text.preview.leaves, ICONS.leaf, () => preview().setLeaves(!leafy))
  const nearer = tool(text.preview.nearer, ICONS.plus, () => preview().zoom(STEP))
  const farther = tool(text.preview.farther, ICONS.minus, () => preview().zoom(1 / STEP))
  const choice = viewChoice(name => preview().view(name))
  nameFirst(store, choice.options[1]!)
  const turning = el('div', { class: 'afloat views', role: 'group', 'aria-label': text.preview.views }, ...views)
  const looking = el('div', { class: 'afloat looking' }, leaves, nearer, farther)
  return {
    elements: [turning, choice, looking],
    show: status => {
      leafy = status.leaves
      turning.hidden = choice.hidden = looking.hidden = status.shows === 'empty' || status.webgl === 'absent'
      for (const [place, name] of VIEWS.entries())
        views[place]!.setAttribute('aria-pressed', String(status.view === name))
      choice.value = status.view
      leaves.hidden = status.shows !== 'model'
      leaves.setAttribute('aria-pressed', String(leafy))
    },
  }
}

/** Name the view that lies over the photo, or over the front as it was drawn. */
function nameFirst(store: Store, element: HTMLElement): void {
  store.watch(
    ({ source, photo }) => source === 'sketch' && !photo?.url,
    drawn => {
      element.textContent = drawn ? text.sheets.drawing : text.preview.view.photo
    },
  )
}

/** Make the switch between the live skeleton and the grown tree; shown where there are both. */
export function showsSwitch(store: Store): HTMLElement {
  const choice = (shows: 'live' | 'model', [short, more]: readonly [string, string]) => {
    const made = button(
      { class: 'button' },
      () => store.set({ shows }),
      el('span', {}, short, el('span', { class: 'roomy' }, more)),
    )
    store.watch(
      state => state.shows === shows,
      on => made.setAttribute('aria-pressed', String(on)),
    )
    return made
  }
  const attributes = { class: 'afloat shows', role: 'group', 'aria-label': text.preview.shows }
  const both = el('div', attributes, choice('live', text.preview.live), choice('model', text.preview.grown))
  store.watch(
    ({ grown, tree }) => grown !== null && tree !== null,
    yes => {
      both.hidden = !yes
    },
  )
  return both
}

/** Make the views' choice for where there is no room for their buttons. */
function viewChoice(choose: (name: View) => void): HTMLSelectElement {
  const freely = el('option', { value: 'free', hidden: true }, text.preview.freely)
  const named = VIEWS.map(name => el('option', { value: name }, text.preview.view[name]))
  const made = el('select', { class: 'afloat view-choice', 'aria-label': text.preview.views }, freely, ...named)
  made.addEventListener('change', () => choose(made.value as View))
  return made
}

function tool(label: string, drawing: string, use: () => void): HTMLButtonElement {
  return button({ class: 'button square', 'aria-label': label, title: label }, use, icon(drawing))
}
