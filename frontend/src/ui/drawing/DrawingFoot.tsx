import { isPaper } from '../../sheets'
import { text } from '../../text'
import { Icon } from '../parts/Icon'
import { IconButton } from '../parts/IconButton'
import { ICONS } from '../parts/icons'
import { useStore, useStudio } from '../parts/useStore'
import type { Zoom } from './sheetSketches'

const { brushes: words } = text.sheets

/** How wide each brush is, as a share of the paper's height; a pencil has no width. */
export const BRUSHES = [
  [null, words.pencil],
  [0.008, words.fine],
  [0.018, words.medium],
  [0.036, words.broad],
] as const
/** The diameter of a brush's dot as a factor of its width, CSS px. */
const DOT_SCALE = 480
const ZOOM_FACTOR = 1.25

/** Return the brush some steps wider than another, between the thinnest and the widest. */
export function nextBrush(brush: number | null, steps: number): number | null {
  const at = BRUSHES.findIndex(([width]) => width === brush)
  return BRUSHES[Math.min(Math.max(at + steps, 0), BRUSHES.length - 1)]![0]
}

/** The foot of the drawing: the brushes on paper, or the button that opens the side's sheet. */
export function DrawingFoot() {
  const { sheets } = useStudio()
  const onPaper = useStore(state => isPaper(state, state.active))
  const canOpenSide = useStore(
    ({ sheets: open, history }) =>
      open?.source === 'photo' && open.side === null && history.present.branches.length > 0,
  )
  return (
    <div class="drawing-foot">
      <div class="brushes" role="group" aria-label={words.group} hidden={!onPaper}>
        {BRUSHES.map(([brush, label]) => (
          <BrushButton key={label} brush={brush} label={label} />
        ))}
      </div>
      <button
        type="button"
        class="button outlined side-opener"
        title={text.sheets.openWhy}
        hidden={!canOpenSide}
        onClick={() => sheets.openSide()}
      >
        <Icon path={ICONS.sheet} />
        {text.sheets.open}
      </button>
    </div>
  )
}

function BrushButton({ brush, label }: { readonly brush: number | null; readonly label: string }) {
  const { sheets } = useStudio()
  const isChosen = useStore(state => state.brush === brush && state.tool === 'branch')
  return (
    <button
      type="button"
      class="button square"
      title={label}
      aria-label={label}
      aria-pressed={isChosen}
      onClick={() => sheets.chooseBrush(brush)}
    >
      {brush === null ? (
        <Icon path={ICONS.pencil} />
      ) : (
        <span class="brush-dot" style={{ '--dot': `${brush * DOT_SCALE}px` }} />
      )}
    </button>
  )
}

interface ZoomProps {
  readonly zoom: Zoom
  /** CSS px per px of the active sheet. */
  readonly scale: number
}

/** The bar that zooms the active sheet. */
export function ZoomBar({ zoom, scale }: ZoomProps) {
  const { tools: words } = text
  return (
    <div class="zoombar" role="group" aria-label={words.zoom}>
      <IconButton
        label={words.withKey(words.zoomOut, '−')}
        icon={ICONS.minus}
        onClick={() => zoom.zoom(1 / ZOOM_FACTOR)}
      />
      <button
        type="button"
        class="button zoom-percent"
        title={words.toActual}
        aria-label={words.actual(scale)}
        onClick={() => zoom.actual()}
      >
        {words.percent(scale)}
      </button>
      <IconButton label={words.withKey(words.zoomIn, '+')} icon={ICONS.plus} onClick={() => zoom.zoom(ZOOM_FACTOR)} />
      <button
        type="button"
        class="button zoom-fit"
        title={words.withKey(words.fitWhole, 'F')}
        onClick={() => zoom.fit()}
      >
        <Icon path={ICONS.fit} />
        <span class="tool-label">{words.fit}</span>
      </button>
    </div>
  )
}
