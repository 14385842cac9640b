import { el } from './dom'
import { sheetHead } from './sheetHead'

/** Make a panel that opens over the stage, on a phone from below; Escape and a click beside it close it. */
export function makePanel(id: string, title: string, ...content: readonly Node[]): HTMLElement {
  const heading = `${id}-title`
  const head = sheetHead(heading, title, () => panel.hidePopover())
  const panel = el('div', { class: 'panel', id, popover: 'auto', role: 'dialog', 'aria-labelledby': heading })
  panel.append(head, ...content)
  const place = () => placeOver(panel)
  panel.addEventListener('beforetoggle', event => {
    if (event.newState === 'open') place()
    window[event.newState === 'open' ? 'addEventListener' : 'removeEventListener']('resize', place)
  })
  return panel
}

/** Name the panel that a button opens and closes. */
export function opening(panel: HTMLElement): Record<string, string> {
  return { popovertarget: panel.id, 'aria-haspopup': 'dialog' }
}

/** Lay a panel above the bar that opens it; the stylesheet decides otherwise where there is no room. */
function placeOver(panel: HTMLElement): void {
  const bar = panel.closest('.growbar')?.getBoundingClientRect()
  const pane = panel.closest('.previewpane')?.getBoundingClientRect()
  if (!bar || !pane) return
  panel.style.setProperty('--left', `${bar.left}px`)
  panel.style.setProperty('--width', `${bar.width}px`)
  panel.style.setProperty('--above', `${window.innerHeight - bar.top}px`)
  panel.style.setProperty('--room', `${bar.top - pane.top}px`)
}
