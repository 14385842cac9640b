import { text } from '../../text'
import { Icon } from '../parts/Icon'
import { IconButton } from '../parts/IconButton'
import { ICONS } from '../parts/icons'
import type { Zoom } from './sheetSketches'

const FACTOR = 1.25

interface Props {
  readonly zoom: Zoom
  /** CSS px per px of the active sheet. */
  readonly scale: number
}

/** The bar that zooms the active sheet. */
export function ZoomBar({ zoom, scale }: Props) {
  const { tools: words } = text
  return (
    <div class="zoombar" role="group" aria-label={words.zoom}>
      <IconButton label={words.withKey(words.zoomOut, '−')} icon={ICONS.minus} onClick={() => zoom.zoom(1 / FACTOR)} />
      <button
        type="button"
        class="button zoom-percent"
        title={words.toActual}
        aria-label={words.actual(scale)}
        onClick={() => zoom.actual()}
      >
        {words.percent(scale)}
      </button>
      <IconButton label={words.withKey(words.zoomIn, '+')} icon={ICONS.plus} onClick={() => zoom.zoom(FACTOR)} />
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
