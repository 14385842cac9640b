import { text } from '../text'
import { el } from './dom'

/** As the stylesheet has it, per cent, until it is moved. */
const FIRST = 55
const FEWEST = 30
const MOST = 75
const STEP = 5

/** Make the handle between the two panes: it sets `--split`, the share of the first one in per cent, on `host`. */
export function divider(host: HTMLElement): HTMLElement {
  let share = FIRST
  const handle = el('div', { class: 'divider', role: 'separator', tabindex: 0, 'aria-orientation': 'vertical' })
  handle.ariaLabel = text.workspace.divider
  const set = (wanted: number) => {
    share = Math.min(MOST, Math.max(FEWEST, wanted))
    host.style.setProperty('--split', `${share}%`)
    handle.ariaValueNow = String(Math.round(share))
  }
  handle.ariaValueMin = String(FEWEST)
  handle.ariaValueMax = String(MOST)
  handle.ariaValueNow = String(FIRST)
  handle.addEventListener('pointerdown', event => handle.setPointerCapture(event.pointerId))
  handle.addEventListener('pointermove', event => {
    const { left, width } = host.getBoundingClientRect()
    if (handle.hasPointerCapture(event.pointerId)) set(((event.clientX - left) / width) * 100)
  })
  handle.addEventListener('keydown', event => {
    const way = { ArrowLeft: -STEP, ArrowRight: STEP }[event.key]
    if (way) set(share + way)
  })
  return handle
}
