import { useEffect, useRef } from 'preact/hooks'
import type { Tracks } from '../../api/types'
import { clipOf } from '../../sheets'
import { text } from '../../text'
import { followPlayhead } from '../parts/usePlayhead'
import { useStore, useStudio } from '../parts/useStore'
import type { Film } from './film'
import { drawTracks, showFilm } from './screen'
import './clipScreen.css'

interface Props {
  readonly film: Film
  /** Points that were followed; null where they are not shown. */
  readonly tracks: Tracks | null
}

/** The video in the place of the sheet, at the playhead, with the points that were followed. */
export function ClipScreen({ film, tracks }: Props) {
  const { playhead } = useStudio()
  const clip = useStore(clipOf)
  const picture = useRef<HTMLCanvasElement>(null)
  const over = useRef<HTMLCanvasElement>(null)
  useEffect(() => showFilm(picture.current!, film), [film])
  useEffect(() => {
    const canvas = over.current!
    const draw = () => {
      fitPixels(canvas)
      if (tracks && clip) drawTracks(canvas, tracks, playhead.frame, clip.width)
      else canvas.getContext('2d')!.clearRect(0, 0, canvas.width, canvas.height)
    }
    const resizing = new ResizeObserver(draw)
    resizing.observe(canvas)
    const end = followPlayhead(playhead, draw)
    return () => {
      resizing.disconnect()
      end()
    }
  }, [tracks, clip, playhead])
  if (!clip) return null
  return (
    <div class="clip-screen" role="img" aria-label={text.clip.screen}>
      <div class="clip-picture" style={{ '--ratio': `${clip.width} / ${clip.height}` }}>
        <canvas ref={picture} />
        <canvas ref={over} />
      </div>
    </div>
  )
}

/** Give a canvas as many pixels as the screen has there. */
function fitPixels(canvas: HTMLCanvasElement): void {
  const [width, height] = [canvas.clientWidth, canvas.clientHeight].map(side => Math.round(side * devicePixelRatio))
  if (canvas.width !== width || canvas.height !== height) Object.assign(canvas, { width, height })
}
