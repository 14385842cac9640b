import { el } from './dom'
import './dropVeil.css'

/** What can become of files that are dragged. */
export interface Way {
  /** What it is, and perhaps what it is for. */
  readonly words: readonly string[]
  /** The part of the page that it is for; the whole page where there is none. */
  readonly over?: Element | undefined
  /** Absent: they are opened as what they are. */
  take?(file: File): void
}

/** What lies over the page while files are dragged over it: a field for each way, one below the other. */
export interface DropVeil {
  show(ways: readonly Way[], at: MouseEvent): void
  hide(): void
  /** Give the way that the pointer is at. */
  wayAt(ways: readonly Way[], at: MouseEvent): Way | undefined
}

/** Without news for so long, ms, the files have left the page. */
const LEFT_MS = 300

/** Make the veil; it is out of sight until files come. */
export function dropVeil(): DropVeil {
  const veil = el('div', { class: 'drop-veil', hidden: true })
  document.body.append(veil)
  let leaving = 0
  const hide = () => {
    veil.hidden = true
  }
  const wayAt = (ways: readonly Way[], { clientY }: MouseEvent) => {
    const { top, height } = placeOf(ways)
    const field = Math.floor(((clientY - top) / height) * ways.length)
    return ways[Math.min(Math.max(field, 0), ways.length - 1)]
  }
  return {
    hide,
    wayAt,
    show: (ways, at) => {
      const { left, top, width, height } = placeOf(ways)
      for (const [side, px] of Object.entries({ left, top, width, height })) veil.style.setProperty(side, `${px}px`)
      veil.replaceChildren(...ways.map(way => field(way, way === wayAt(ways, at))))
      veil.hidden = false
      clearTimeout(leaving)
      leaving = window.setTimeout(hide, LEFT_MS)
    },
  }
}

function field({ words: [title = '', why] }: Way, chosen: boolean): HTMLElement {
  const said = why ? el('span', {}, why) : null
  return el('p', { class: chosen ? 'drop-field chosen' : 'drop-field' }, el('strong', {}, title), said)
}

function placeOf([way]: readonly Way[]): DOMRect {
  return way?.over?.getBoundingClientRect() ?? new DOMRect(0, 0, innerWidth, innerHeight)
}
