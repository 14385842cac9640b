import type { Model, State } from '../state'
import { toWire } from '../strokes'
import { fileName } from '../studio/project'
import type { Studio } from '../studio/studio'
import { text } from '../text'
import { linkItem } from './copyLink'
import { button, el, icon } from './dom'
import { figuresOfModel } from './figures'
import { ICONS } from './icons'
import { makePanel } from './panel'
import { saveProject } from './projectFile'
import { saveFile } from './saving'

type Words = readonly [label: string, about: string]

/** What has an entry of its own, or is none to take away. */
const KNOWN = ['tree.glb', 'preview.png', 'strokes.json', 'project']

/** Make the panel with everything that can be taken away; `picture` takes one of what is shown. */
export function downloadsPanel(studio: Studio, picture: () => Promise<Blob>): HTMLElement {
  const { store } = studio
  const tree = el('div', { class: 'takings' })
  const image = take(ICONS.photo, text.files.png, () => savePicture(studio, picture))
  const project = take(ICONS.box, text.files.project, () => saveProject(studio))
  const strokes = take(ICONS.stroke, text.files.strokes, () => saveStrokes(studio))
  const link = linkItem(store)
  store.watch(treeOf, model => tree.replaceChildren(...(model ? treeItems(model) : [])))
  store.watch(
    state => state,
    state => {
      const { crown } = state.history.present
      image.hidden = !state.grown && !state.tree
      project.hidden = !state.photo || !crown
      strokes.hidden = project.hidden
    },
  )
  return makePanel('downloads', text.files.title, tree, image, project, strokes, link)
}

/** Make the link that downloads the tree at once. */
export function treeLink({ store }: Studio): HTMLElement {
  const link = el('a', { class: 'button outlined tree-link' }, icon(ICONS.download), text.files.glbShort)
  store.watch(treeOf, model => {
    link.hidden = !model
    if (!model) return
    link.href = model.files['tree.glb']!
    link.download = fileName(model.name, '.glb')
    link.setAttribute('aria-label', text.files.download(text.files.glbShort))
  })
  return link
}

/** Tell whether there is anything to take away. */
export function hasTakings({ photo, history, model }: State): boolean {
  return treeOf({ model }) !== null || (photo !== null && history.present.crown !== null)
}

function treeOf({ model }: { readonly model: Model | null }): Model | null {
  return model?.files['tree.glb'] ? model : null
}

/** List the tree and those of its files that this page does not know. */
function treeItems(model: Model): HTMLElement[] {
  const [label, about] = text.files.glb
  const size = figuresOfModel(model).find(({ row }) => row === 'size')?.value
  const glb = fileLink(
    ICONS.tree,
    [size ? `${label} · ${size}` : label, about],
    model.files['tree.glb']!,
    fileName(model.name, '.glb'),
  )
  glb.classList.add('first')
  const others = Object.entries(model.files).filter(([name]) => !KNOWN.includes(name))
  return [
    glb,
    ...others.map(([name, url]) =>
      fileLink(ICONS.paper, [name, text.files.other], url, fileName(model.name, `.${name}`)),
    ),
  ]
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
  const json = JSON.stringify(toWire(store.strokes))
  saveFile(new Blob([json], { type: 'application/json' }), fileName(store.state.name, '.strokes.json'))
}

function take(drawing: string, words: Words, save: () => Promise<void>): HTMLButtonElement {
  return button({ class: 'taking' }, () => void save(), icon(drawing), wordsOf(words))
}

function fileLink(drawing: string, words: Words, href: string, download: string): HTMLElement {
  return el('a', { class: 'taking', href, download }, icon(drawing), wordsOf(words))
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
