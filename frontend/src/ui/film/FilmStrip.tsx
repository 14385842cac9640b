import { useEffect, useRef, useState } from 'preact/hooks'
import { clipOf } from '../../sheets'
import type { Clip, State } from '../../state'
import { text } from '../../text'
import { chooseVideo } from '../parts/files'
import { Icon } from '../parts/Icon'
import { ICONS } from '../parts/icons'
import { usePlayhead } from '../parts/usePlayhead'
import { useStore, useStudio } from '../parts/useStore'
import { FrameSlider } from './FrameSlider'
import { Transport } from './Transport'
import { tracksIn } from './tracksIn'
import './filmStrip.css'

const { strip: words } = text.clip

/** What is shown in the sheet's place. */
export interface Watching {
  /** Whether the video is watched instead of drawn on. */
  readonly isOn: boolean
  readonly hasTracks: boolean
}

interface Props {
  readonly watching: Watching
  set(watching: Watching): void
  /** Called while a frame is looked for, and with false once it is chosen. */
  peek(on: boolean): void
}

/** The clip below the sheet: a switch between drawing and watching, the frames, and the player where no tree has one. */
export function FilmStrip({ watching, set, peek }: Props) {
  const clip = useStore(clipOf)
  if (!clip) return null
  return (
    <div class="film-strip">
      <Head clip={clip} watching={watching} set={set} />
      {clip.id !== null && (watching.isOn ? <Player /> : <Frames clip={clip} peek={peek} />)}
    </div>
  )
}

/** The player of the video alone; a tree that moves has one of its own, which moves both. */
function Player() {
  const { playhead } = useStudio()
  usePlayhead(playhead)
  return playhead.hasTree ? null : <Transport playhead={playhead} />
}

function Head({ clip, watching, set }: Omit<Props, 'peek'> & { readonly clip: Clip }) {
  const count = useStore(state => tracksIn(state)?.points.length ?? 0)
  return (
    <div class="film-head">
      <div class="film-modes" role="group" aria-label={words.modes}>
        {([false, true] as const).map(isOn => (
          <button
            type="button"
            class="button small"
            key={String(isOn)}
            aria-pressed={watching.isOn === isOn}
            disabled={clip.id === null}
            onClick={() => set({ ...watching, isOn })}
          >
            <Icon path={isOn ? ICONS.film : ICONS.pencil} />
            {isOn ? words.watch : words.draw}
          </button>
        ))}
      </div>
      {watching.isOn && count > 0 && (
        <button
          type="button"
          class="button outlined small"
          title={words.tracksWhy}
          aria-pressed={watching.hasTracks}
          onClick={() => set({ ...watching, hasTracks: !watching.hasTracks })}
        >
          {words.tracks}
        </button>
      )}
      <Words clip={clip} isWatching={watching.isOn} />
    </div>
  )
}

/** What is said of the clip: which frame is drawn on, how long it is, or that it has to be chosen again. */
function Words({ clip, isWatching }: { readonly clip: Clip; readonly isWatching: boolean }) {
  const studio = useStudio()
  const frame = useStore(frameDrawnOn)
  const fault = useStore(({ faults }) => faults.clip?.text)
  const count = useStore(state => tracksIn(state)?.points.length ?? 0)
  const isLost = clip.id === null
  if (isLost || fault)
    return (
      <>
        <p class="film-words fault" role="alert">
          {fault ?? words.lost}
        </p>
        <button
          type="button"
          class="button outlined small"
          onClick={() => chooseVideo(file => void studio.clips.sendAgain(file))}
        >
          {words.choose}
        </button>
      </>
    )
  const facts = isWatching && count ? words.tracked(count) : words.facts(clip.seconds, clip.frames_per_second)
  return (
    <p class="film-words">
      {!isWatching && <strong>{words.now(frame, clip.frames)}</strong>} <span class="soft">{facts}</span>
    </p>
  )
}

/** How long no key must be pressed before a frame is taken as chosen, ms. */
const REST_MS = 450

/** The frames in a row, of which one is drawn on. */
function Frames({ clip, peek }: { readonly clip: Clip } & Pick<Props, 'peek'>) {
  const { playhead, strokes } = useStudio()
  const drawnOn = useStore(frameDrawnOn)
  const [looked, look] = useState<number | null>(null)
  const resting = useRef<ReturnType<typeof setTimeout>>(undefined)
  useEffect(() => () => clearTimeout(resting.current), [])
  const choose = (frame: number) => {
    clearTimeout(resting.current)
    strokes.chooseFrame(frame)
    look(null)
    peek(false)
  }
  const tryFrame = (frame: number, isKey: boolean) => {
    clearTimeout(resting.current)
    playhead.showFrame(frame)
    look(frame)
    peek(true)
    if (isKey) resting.current = setTimeout(() => choose(frame), REST_MS)
  }
  return <FrameSlider clip={clip} frame={looked ?? drawnOn} look={tryFrame} choose={choose} />
}

function frameDrawnOn({ sheets }: State): number {
  return sheets?.source === 'clip' ? sheets.front.frame : 0
}
