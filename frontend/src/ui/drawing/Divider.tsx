import { text } from '../../text'

/** Per cent; the first is also in the stylesheet. */
const INITIAL = 55
const MIN = 30
const MAX = 75
const STEP = 5

interface Props {
  /** The share of the first pane, per cent; null until it is moved. */
  readonly split: number | null
  move(split: number): void
}

/** The handle that sets the width of the two panes. */
export function Divider({ split, move }: Props) {
  const now = split ?? INITIAL
  const moveTo = (wanted: number) => move(Math.min(MAX, Math.max(MIN, wanted)))
  const drag = (event: PointerEvent) => {
    const handle = event.currentTarget as HTMLElement
    const { left, width } = handle.parentElement!.getBoundingClientRect()
    if (handle.hasPointerCapture(event.pointerId)) moveTo(((event.clientX - left) / width) * 100)
  }
  const press = ({ key }: KeyboardEvent) => {
    const step = { ArrowLeft: -STEP, ArrowRight: STEP }[key]
    if (step) moveTo(now + step)
  }
  return (
    <div
      class="divider"
      role="separator"
      tabIndex={0}
      aria-orientation="vertical"
      aria-label={text.workspace.divider}
      aria-valuemin={MIN}
      aria-valuemax={MAX}
      aria-valuenow={Math.round(now)}
      onPointerDown={event => event.currentTarget.setPointerCapture(event.pointerId)}
      onPointerMove={drag}
      onKeyDown={press}
    />
  )
}
