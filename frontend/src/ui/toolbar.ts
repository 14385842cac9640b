import type { State, Tool } from '../state'
import { isEmpty } from '../strokes'
import type { Studio } from '../studio/studio'
import { text } from '../text'
import { button, el, icon } from './dom'
import { ICONS } from './icons'
import { withCtrl } from './shortcutKeys'
import { strokeList } from './strokeList'
import './toolbar.css'

const KEYS: Readonly<Record<Tool, string>> = { crown: 'C', branch: 'B', scale: 'M', select: 'V' }

/** Make the bar of the drawing tools, and of what can be done with strokes. */
export function toolbar(studio: Studio): HTMLElement {
  const { store, sketchbook } = studio
  const tools = (['crown', 'branch', 'scale', 'select'] as const).map(tool => toolButton(tool, studio))
  const bar = el(
    'div',
    { class: 'toolbar', role: 'group', 'aria-label': text.tools.group },
    ...tools,
    el('span', { class: 'tool-rule' }),
    edit({ label: text.tools.undo, key: withCtrl('Z'), path: ICONS.undo }, () => sketchbook.undo()),
    edit({ label: text.tools.redo, key: withCtrl('Shift+Z'), path: ICONS.redo }, () => sketchbook.redo()),
    edit({ label: text.tools.remove, key: 'Del', path: ICONS.remove }, () => sketchbook.remove()),
    edit({ label: text.tools.clear, path: ICONS.clear }, () => sketchbook.clear()),
    ...strokeList(studio),
  )
  const edits = [...bar.querySelectorAll('.tool-edit')]
  store.watch(
    state => state,
    state => showPossible(edits, state),
  )
  return bar
}

function toolButton(tool: Tool, { store, sketchbook }: Studio): HTMLButtonElement {
  const title = text.tools.withKey(text.tools[tool], KEYS[tool])
  const label = el('span', { class: 'tool-label' }, text.tools[tool])
  const made = button({ class: 'button tool tool-kind', title, 'aria-keyshortcuts': KEYS[tool] }, () =>
    sketchbook.hold(tool),
  )
  made.append(icon(ICONS[tool]), label)
  made.dataset.tool = tool
  if (tool === 'scale')
    store.watch(
      state => state.source === 'sketch',
      sketched => {
        made.hidden = sketched // paper has no measure
      },
    )
  store.watch(
    state => state.tool,
    held => made.setAttribute('aria-pressed', String(held === tool)),
  )
  return made
}

function edit({ label, key, path }: { label: string; key?: string; path: string }, act: () => void): HTMLButtonElement {
  const title = key ? text.tools.withKey(label, key) : label
  const made = button({ class: 'button tool tool-edit', title, 'aria-label': title }, run, icon(path))
  function run(): void {
    if (made.ariaDisabled !== 'true') act()
  }
  return made
}

/** Dim what cannot be done now; it stays where the focus can rest on it. */
function showPossible(edits: readonly Element[], { history, selection }: State): void {
  const possible = [history.past.length > 0, history.future.length > 0, selection !== null, !isEmpty(history.present)]
  for (const [index, one] of edits.entries()) one.ariaDisabled = String(!possible[index])
}
