import { type ComponentChildren, render } from 'preact'
import { act } from 'preact/test-utils'
import type { Studio } from '../../src/studio/studio'
import { StudioProvider } from '../../src/ui/parts/useStore'

let mounted: HTMLElement | null = null

/** Render a part of the page into an empty document; return the element that holds it. */
export function mount(studio: Studio, part: ComponentChildren): HTMLElement {
  if (mounted) render(null, mounted)
  const host = document.createElement('div')
  mounted = host
  document.body.replaceChildren(host)
  redraw(host, studio, part)
  return host
}

/** Render a part again, with other properties. */
export function redraw(host: HTMLElement, studio: Studio, part: ComponentChildren): void {
  void act(() => render(<StudioProvider value={studio}>{part}</StudioProvider>, host))
}
