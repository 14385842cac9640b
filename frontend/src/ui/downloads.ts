import type { Model } from '../api/types'
import { groundOf, isDrawn, isPaper } from '../sheets'
import type { State } from '../state'
import { onSheet, toWire } from '../strokes'
import { canTrace } from '../studio/inputs'
import { fileName } from '../studio/project'
import { sketchToWire } from '../studio/sketches'
import type { Studio } from '../studio/studio'
import { aloneOf, treeOf, variantsOf } from '../studio/variants'
import { text } from '../text'
import { linkItem } from './copyLink'
import { button, el, icon } from './dom'
import './downloads.css'
import { ICONS } from './icons'
import { makePanel } from './panel'
import { saveProject } from './projectFile'
import { saveFile } from './saving'
import { type Shelf, type Taking, takingsOf } from './takings'

type Words = readonly [label: string, about: string]

const DRAWINGS: Readonly<Record<Shelf, string>> = {
  tree: ICONS.tree,
  levels: ICONS.layers,
  formats: ICONS.paper,
  skeleton: ICONS.bones,
}

/** What the panel asks of the page: a picture of what is shown, and the settings of what files there are. */
export interface DownloadsAsk {
  picture(): Promise<Blob>
  moreFormats(): void
}

/** Make the panel with everything that can be taken away. */
export function downloadsPanel(studio: Studio, ask: DownloadsAsk): HTMLElement {
  const { store } = studio
  const tree = el('div', { class: 'takings' })
  const image = take(ICONS.photo, text.files.png, () => savePicture(studio, ask.picture))
  const project = take(ICONS.box, text.files.project, () => saveProject(studio))
  const strokes = take(ICONS.stroke, text.files.strokes, () => saveStrokes(studio))
  const more = take(ICONS.sliders, text.files.moreFormats, async () => ask.moreFormats())
  more.classList.add('more-formats')
  const link = linkItem(store)
  store.watch(chosenOf, () => {
    const { model, variant } = store.state
    tree.replaceChildren(...(model && treeOf(model, variant) ? treeItems(model, variant) : []))
  })
  store.watch(
    state => state,
    state => {
      image.hidden = !state.grown && !state.tree
      project.hidden = !canTrace(state)
      strokes.hidden = project.hidden
      more.hidden = chosenOf(state) === null
    },
  )
  const drawing = shelf(text.files.groups.drawing, image, project, strokes, link)
  return makePanel('downloads', text.files.title, tree, more, drawing)
}

/** Make the link that downloads the tree at once. */
export function treeLink({ store }: Studio): HTMLElement {
  const link = el('a', { class: 'button outlined tree-link' }, icon(ICONS.download), text.files.glbShort)
  store.watch(chosenOf, url => {
    const { model, variant } = store.state
    link.hidden = !url
    if (!url || !model) return
    link.href = url
    link.download = takingsOf(model, variant)[0]!.saved
    link.setAttribute('aria-label', text.files.download(text.files.glbShort))
  })
  return link
}

/** Tell whether there is anything to take away. */
export function hasTakings(state: State): boolean {
  return chosenOf(state) !== null || canTrace(state)
}

/** Where the tree is that is looked at; another address says that there are other files to take. */
function chosenOf({ model, variant }: State): string | null {
  return (model && treeOf(model, variant)) ?? null
}

/** List the files of one tree, shelf by shelf. */
function treeItems(model: Model, variant: number): HTMLElement[] {
  const count = variantsOf(model)
  const takings = takingsOf(aloneOf(model, variant), variant)
  const shelves = [...new Set(takings.map(taking => taking.shelf))]
  return shelves.map(name => {
    const title = name === 'tree' && count > 1 ? text.files.variant(variant, count) : text.files.groups[name]
    return shelf(title, ...takings.filter(taking => taking.shelf === name).map(fileLink))
  })
}

function shelf(title: string, ...items: readonly HTMLElement[]): HTMLElement {
  return el('section', { class: 'taking-shelf' }, el('h3', {}, title), ...items)
}

async function savePicture({ store }: Studio, picture: () => Promise<Blob>): Promise<void> {
  try {
    saveFile(await picture(), fileName(store.state.name, '.png'))
    store.fault('preview', null)
  } catch {
    store.fault('preview', { text: text.files.noPicture })
  }
}

async function saveStrokes({ store }: Studio): Promise<void> {
  const { source, name } = store.state
  const save = (what: string, value: unknown) =>
    saveFile(new Blob([JSON.stringify(value)], { type: 'application/json' }), fileName(name, `.${what}.json`))
  if (source === 'photo') save('strokes', toWire(onSheet(store.strokes, 'front')))
  for (const sheet of ['front', 'side'] as const) {
    const ground = groundOf(store.state, sheet)
    if (ground && isPaper(store.state, sheet) && isDrawn(store.strokes, sheet))
      save(sheet, sketchToWire(store.strokes, sheet, ground))
  }
}

function take(drawing: string, words: Words, save: () => Promise<void>): HTMLButtonElement {
  return button({ class: 'taking' }, () => void save(), icon(drawing), wordsOf(words))
}

function fileLink({ shelf, label, about, size, url, saved }: Taking): HTMLElement {
  const words = wordsOf([size ? `${label} · ${size}` : label, about])
  const link = el('a', { class: 'taking', href: url, download: saved }, icon(DRAWINGS[shelf]), words)
  link.classList.toggle('first', shelf === 'tree')
  return link
}

/** Give an entry's name and, below it, what it is. */
export function wordsOf([label, about]: Words): HTMLElement {
  return el(
    'span',
    { class: 'taking-words' },
    el('span', { class: 'taking-label' }, label),
    el('span', { class: 'taking-about' }, about),
  )
}
