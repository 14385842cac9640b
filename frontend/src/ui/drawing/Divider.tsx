import { text } from '../../text'

/** As the stylesheet has it, per cent, until it is moved. */
const FIRST = 55
const FEWEST = 30
const MOST = 75
const STEP = 5

interface Props {
  /** The share of the first pane, per cent; null until it is moved. */
  readonly split: number | null
  move(split: number): void
}

/** The handle between the two panes. */
export function Divider({ split, move }: Props) {
  const now = split ?? FIRST
  const moveTo = (wanted: number) => move(Math.min(MOST, Math.max(FEWEST, wanted)))
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
      aria-valuemin={FEWEST}
      aria-valuemax={MOST}
      aria-valuenow={Math.round(now)}
      onPointerDown={event => event.currentTarget.setPointerCapture(event.pointerId)}
      onPointerMove={drag}
      onKeyDown={press}
    />
  )
}
