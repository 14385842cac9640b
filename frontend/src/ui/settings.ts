import type { Limits } from '../api/types'
import type { State } from '../state'
import type { Studio } from '../studio/studio'
import { text } from '../text'
import { button, el } from './dom'
import { numberField, type Row } from './fields'
import { anotherButton } from './growButtons'
import { ownRow } from './leafRow'
import { makePanel } from './panel'
import { settingField } from './settingField'
import { defaultsOf, type Group, groupsOf } from './settingGroups'
import './settings.css'
import type { Span } from './parts/spans'
import { standingOf } from './standing'
import { makeTabs, type Tab, type Tabs } from './tabs'

/** The settings; `open` shows those of a group, by its name. */
export interface SettingsPanel {
  readonly panel: HTMLElement
  open(group: string): void
}

const SEED: Span = { min: 0, max: Number.MAX_SAFE_INTEGER, whole: true }

/** Make the panel with every setting that the service takes, the seed and the person's own leaf. */
export function settingsPanel(studio: Studio): SettingsPanel {
  const { store } = studio
  const place = el('div', { class: 'settings' })
  const panel = makePanel('settings', text.settings.title, place, foot(studio))
  let rows: Row[] = []
  let tabs: Tabs | null = null
  store.watch(
    state => state.limits,
    limits => {
      rows = []
      tabs = limits ? tabsOf(studio, limits, rows) : null
      place.replaceChildren(...(tabs ? [tabs.element] : []))
    },
  )
  panel.addEventListener('toggle', () => {
    for (const row of rows) row.show()
  })
  const open = (group: string) => {
    tabs?.open(group)
    panel.showPopover()
  }
  return { panel, open }
}

/** Make the groups' tabs; their rows are entered in `rows`. */
function tabsOf(studio: Studio, limits: Limits, rows: Row[]): Tabs {
  const tabs = groupsOf(limits).map((group): Tab => {
    const fields = group.settings.map(([name, allowed]) => [name, settingField(studio, name, allowed)] as const)
    rows.push(...fields.map(([, row]) => row))
    const height = fields.find(([name]) => name === 'height')?.[1]
    if (height) followScale(studio, height)
    const parts = fields.flatMap(([name, row]) =>
      name === 'species' ? [row.element, ownRow(studio, 'leaf'), ownRow(studio, 'fruit')] : [row.element],
    )
    return { ...group, content: [lead(group), ...parts, ...(group.name === 'tree' ? [seedRow(studio)] : [])] }
  })
  return makeTabs('settings', text.settings.groupsLabel, tabs)
}

function lead({ name }: Group): Node {
  const words = text.settings.leads[name]
  return words ? el('p', { class: 'settings-lead' }, words) : document.createDocumentFragment()
}

/** Say at the height that the measured line has taken its place. */
function followScale({ store }: Studio, { element }: Row): void {
  const note = el('p', { class: 'setting-note', id: 'setting-height-note' })
  element.append(note)
  const inputs = [...element.querySelectorAll('input')]
  store.watch(
    state => state.history.present.scale,
    scale => {
      note.textContent = scale ? text.settings.heightMeasured(text.metres(scale.metres)) : ''
      for (const input of inputs) input.disabled = scale !== null
    },
  )
}

function foot(studio: Studio): HTMLElement {
  const { store } = studio
  const defaults = () => store.set({ settings: defaultsOf(store.state.limits) })
  const reset = button({ class: 'button outlined' }, defaults, text.settings.reset)
  const again = el('p', { class: 'settings-again', role: 'status' })
  store.watch(onlyFilesChanged, yes => {
    again.textContent = yes ? text.settings.fileAgain : ''
  })
  return el('footer', { class: 'settings-foot' }, reset, again)
}

function onlyFilesChanged(state: State): boolean {
  return standingOf(state) === 'filesChanged'
}

function seedRow(studio: Studio): HTMLElement {
  const { store } = studio
  const words = { name: 'seed', label: text.settings.seed, why: text.settings.seedWhy, span: SEED, slides: false }
  const row = numberField(
    words,
    () => store.state.seed,
    seed => store.set({ seed }),
  )
  store.watch(state => state.seed, row.show)
  row.element.querySelector('.setting-entry')!.append(anotherButton(studio))
  return row.element
}
