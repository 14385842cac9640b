import { type ComponentChildren, render } from 'preact'
import { act } from 'preact/test-utils'
import type { Studio } from '../../../src/studio/studio'
import { StudioProvider } from '../../../src/ui/parts/useStore'

/** Show a part of the page, and nothing else. */
export function mount(studio: Studio, part: ComponentChildren): Promise<void> {
  render(null, document.body)
  return act(() => render(<StudioProvider value={studio}>{part}</StudioProvider>, document.body))
}
