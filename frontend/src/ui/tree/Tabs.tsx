import type { ComponentChildren } from 'preact'
import { placeAfter } from '../parts/placeAfter'
import './tabs.css'

/** A part that is shown in turn with others. */
export interface Tab {
  readonly name: string
  readonly label: string
  readonly content: ComponentChildren
}

interface Props {
  /** What the ids begin with. */
  readonly id: string
  readonly label: string
  readonly tabs: readonly Tab[]
  /** The one that is open, by its name. */
  readonly chosen: string
  choose(name: string): void
}

/** Tabs above their parts; arrow keys go from one to the next, Home and End to the first and the last. */
export function Tabs({ id, label, tabs, chosen, choose }: Props) {
  const step = ({ key, currentTarget: bar }: KeyboardEvent & { readonly currentTarget: HTMLElement }) => {
    const next = placeAfter(
      key,
      tabs.findIndex(({ name }) => name === chosen),
      tabs.length,
    )
    if (next === undefined) return
    choose(tabs[next]!.name)
    ;(bar.children[next] as HTMLElement).focus()
  }
  return (
    <div>
      <div class="tabs" role="tablist" aria-label={label} onKeyDown={step}>
        {tabs.map(({ name, label: words }) => (
          <button
            type="button"
            class="button tab"
            role="tab"
            id={`${id}-tab-${name}`}
            key={name}
            aria-controls={`${id}-${name}`}
            aria-selected={name === chosen}
            tabIndex={name === chosen ? 0 : -1}
            onClick={() => choose(name)}
          >
            {words}
          </button>
        ))}
      </div>
      {tabs.map(({ name, content }) => (
        <div
          class="tab-part"
          role="tabpanel"
          id={`${id}-${name}`}
          key={name}
          aria-labelledby={`${id}-tab-${name}`}
          hidden={name !== chosen}
        >
          {content}
        </div>
      ))}
    </div>
  )
}
