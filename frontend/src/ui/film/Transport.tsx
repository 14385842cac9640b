import type { TargetedInputEvent } from 'preact'
import { useRef } from 'preact/hooks'
import { type Playhead, SPEEDS } from '../../playhead'
import { text } from '../../text'
import { Icon } from '../parts/Icon'
import { IconButton } from '../parts/IconButton'
import { ICONS } from '../parts/icons'
import { Popover } from '../parts/Popover'
import { RadioButtons } from '../parts/RadioButtons'
import { usePlayhead } from '../parts/usePlayhead'
import './transport.css'

const { transport: words } = text.motion
/** How far apart places are where nothing was filmed, seconds. */
const STEP = 0.05
const STRONGEST = 3
const GAIN_STEP = 0.25

/** How strongly branches move, and how that is set. */
export interface Gain {
  readonly now: number
  set(gain: number): void
}

interface Props {
  readonly playhead: Playhead
  /** Absent where there is no tree that moves. */
  readonly gain?: Gain
}

/** Plays and pauses, goes to a frame, and sets speed and strength; it shows nothing where nothing moves. */
export function Transport({ playhead, gain }: Props) {
  usePlayhead(playhead)
  const { span, playing } = playhead
  if (!span) return null
  return (
    <div class="transport" role="group" aria-label={words.group}>
      <IconButton
        label={playing ? words.pause : words.play}
        icon={playing ? ICONS.pause : ICONS.play}
        class="transport-play"
        onClick={() => (playing ? playhead.pause() : playhead.play())}
      />
      <Scrubber playhead={playhead} />
      <Place playhead={playhead} />
      <Popover
        opener={{
          class: 'button square',
          'aria-label': words.how,
          title: words.how,
          children: <Icon path={ICONS.sliders} />,
        }}
        class="transport-how"
        label={words.how}
      >
        <h3>{words.speed}</h3>
        <RadioButtons
          label={words.speed}
          choices={SPEEDS.map(speed => [String(speed), words.times(speed)])}
          chosen={String(playhead.speed)}
          choose={speed => playhead.setSpeed(Number(speed))}
        />
        {gain && <GainField gain={gain} />}
      </Popover>
    </div>
  )
}

/** The slider that goes to a place; what was playing goes on when it is let go. */
function Scrubber({ playhead }: Props) {
  const goesOn = useRef(false)
  const { span, seconds } = playhead
  const hold = () => {
    goesOn.current = playhead.playing
  }
  const move = (event: TargetedInputEvent<HTMLInputElement>) => {
    playhead.pause()
    playhead.seek(Number(event.currentTarget.value))
  }
  const release = () => {
    if (goesOn.current) playhead.play()
    goesOn.current = false
  }
  return (
    <input
      class="transport-place"
      type="range"
      min={0}
      max={span!.seconds}
      step={span!.framesPerSecond ? 1 / span!.framesPerSecond : STEP}
      value={seconds}
      aria-label={words.place}
      aria-valuetext={words.aloud(frameText(playhead), seconds)}
      onPointerDown={hold}
      onInput={move}
      onPointerUp={release}
      onPointerCancel={release}
    />
  )
}

function Place({ playhead }: Props) {
  const isFilmed = playhead.span?.frames !== undefined
  return (
    <p class="transport-time">
      {isFilmed && <span class="transport-frame">{frameText(playhead)}</span>}
      <span>{words.seconds(playhead.seconds)}</span>
    </p>
  )
}

/** Return the clip's frame in words; empty where nothing was filmed. */
function frameText({ span, frame }: Playhead): string {
  if (!span?.frames) return ''
  return frame === null ? words.back : words.frame(frame, span.frames)
}

function GainField({ gain: { now, set } }: { readonly gain: Gain }) {
  const said = now === 0 ? words.calm : now === 1 ? words.asIs : words.stronger(now)
  return (
    <label class="transport-gain">
      <span>
        {words.gain}: <b>{said}</b>
      </span>
      <input
        type="range"
        min={0}
        max={STRONGEST}
        step={GAIN_STEP}
        value={now}
        aria-valuetext={said}
        onInput={event => set(Number(event.currentTarget.value))}
      />
    </label>
  )
}
