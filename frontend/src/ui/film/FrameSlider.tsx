import { useMemo } from 'preact/hooks'
import { frameUrl } from '../../api/addresses'
import type { Clip } from '../../state'
import { text } from '../../text'

/** How many frames are shown as pictures, and how high they are asked for, px. */
const SHOWN = 12
const HEIGHT = 96
const LEAP = 10

interface Props {
  readonly clip: Clip
  readonly frame: number
  /** Called while a frame is looked for, by a key or the pointer. */
  look(frame: number, isKey: boolean): void
  /** Called when the pointer lets go of a frame. */
  choose(frame: number): void
}

/** A clip's frames in a row, with a handle at one of them: the arrows go frame by frame, Page Up and Down by ten. */
export function FrameSlider({ clip, frame, look, choose }: Props) {
  const { frames, frames_per_second: rate } = clip
  const at = (event: PointerEvent) => frameAt(event, frames)
  const press = (event: KeyboardEvent) => {
    const next = frameAfter(event.key, frame, frames)
    if (next === null) return
    event.preventDefault()
    event.stopPropagation()
    look(next, true)
  }
  const holds = (event: PointerEvent) => (event.currentTarget as HTMLElement).hasPointerCapture(event.pointerId)
  return (
    <div
      class="frame-slider"
      role="slider"
      tabIndex={0}
      aria-label={text.clip.strip.label}
      aria-valuemin={1}
      aria-valuemax={frames}
      aria-valuenow={frame + 1}
      aria-valuetext={text.clip.strip.frame(frame, frames, frame / rate)}
      style={{ '--at': String((frame + 0.5) / frames) }}
      onKeyDown={press}
      onPointerDown={event => {
        event.currentTarget.setPointerCapture(event.pointerId)
        look(at(event), false)
      }}
      onPointerMove={event => holds(event) && look(at(event), false)}
      onPointerUp={event => choose(at(event))}
      onPointerCancel={() => choose(frame)}
    >
      <Pictures clip={clip} />
      <span class="frame-handle" />
    </div>
  )
}

function Pictures({ clip: { id, width, height, frames } }: Pick<Props, 'clip'>) {
  const shown = useMemo(
    () => Array.from({ length: Math.min(SHOWN, frames) }, (_, at) => Math.floor(((at + 0.5) / SHOWN) * frames)),
    [frames],
  )
  return (
    <div class="frame-pictures" style={{ '--ratio': `${width} / ${height}` }}>
      {shown.map(number => (
        <img key={number} src={frameUrl(id!, number, HEIGHT)} alt="" draggable={false} decoding="async" />
      ))}
    </div>
  )
}

/** Return the frame under the pointer. */
function frameAt(event: PointerEvent, frames: number): number {
  const { left, width } = (event.currentTarget as HTMLElement).getBoundingClientRect()
  return within(Math.floor(((event.clientX - left) / width) * frames), frames)
}

/** Return the frame that a key leads to; null where it leads nowhere. */
export function frameAfter(key: string, frame: number, frames: number): number | null {
  const steps: Readonly<Record<string, number>> = {
    ArrowLeft: -1,
    ArrowDown: -1,
    ArrowRight: 1,
    ArrowUp: 1,
    PageDown: -LEAP,
    PageUp: LEAP,
    Home: -frames,
    End: frames,
  }
  const step = steps[key]
  return step === undefined ? null : within(frame + step, frames)
}

function within(frame: number, frames: number): number {
  return Math.min(Math.max(frame, 0), frames - 1)
}
