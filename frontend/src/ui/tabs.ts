import { button, el } from './dom'
import './tabs.css'

/** A part that is shown in turn with others. */
export interface Tab {
  readonly name: string
  readonly label: string
  readonly content: readonly Node[]
}

/** Tabs above their parts; `open` shows a part by its name. */
export interface Tabs {
  readonly element: HTMLElement
  open(name: string): void
}

const WAYS: Readonly<Record<string, number>> = { ArrowLeft: -1, ArrowRight: 1 }

/** Make tabs, the first of them open; arrow keys go from one to the next. */
export function makeTabs(id: string, label: string, tabs: readonly Tab[]): Tabs {
  const heads = tabs.map(({ name, label: words }) =>
    button(
      { class: 'button tab', role: 'tab', id: `${id}-tab-${name}`, 'aria-controls': `${id}-${name}` },
      () => open(name),
      words,
    ),
  )
  const parts = tabs.map(({ name, content }) =>
    el('div', { class: 'tab-part', role: 'tabpanel', id: `${id}-${name}` }, ...content),
  )
  for (const [at, part] of parts.entries()) part.setAttribute('aria-labelledby', heads[at]!.id)
  const bar = el('div', { class: 'tabs', role: 'tablist', 'aria-label': label }, ...heads)
  const open = (name: string) => {
    for (const [at, tab] of tabs.entries()) {
      const chosen = tab.name === name
      parts[at]!.hidden = !chosen
      heads[at]!.ariaSelected = String(chosen)
      heads[at]!.tabIndex = chosen ? 0 : -1
    }
  }
  bar.addEventListener('keydown', ({ key }) => {
    const way = WAYS[key]
    if (!way) return
    const next = heads[(heads.findIndex(head => head.tabIndex === 0) + way + heads.length) % heads.length]
    next?.click()
    next?.focus()
  })
  if (tabs[0]) open(tabs[0].name)
  return { element: el('div', {}, bar, ...parts), open }
}
