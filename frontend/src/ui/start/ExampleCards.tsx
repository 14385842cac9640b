import { useRef } from 'preact/hooks'
import type { Client } from '../../api/client'
import { fromWire } from '../../strokes'
import type { Example, SketchExample } from '../../studio/examples'
import { pairSketches, sketchFrom } from '../../studio/sketches'
import { text } from '../../text'
import { PairPicture, SheetPicture } from '../parts/drawn'
import { mayLeave } from '../parts/files'
import { useLoaded } from '../parts/useLoaded'
import { useStudio } from '../parts/useStore'

/** A bundled example, with its two strokes over its photo once they are there. */
export function ExampleCard({ example }: { readonly example: Example }) {
  const studio = useStudio()
  const photo = useRef<HTMLImageElement>(null)
  const drawn = useLoaded(async () => {
    const [file] = await Promise.all([studio.client.getFile(example.strokes), photo.current!.decode()])
    const { naturalWidth: width, naturalHeight: height } = photo.current!
    return { size: { width, height }, strokes: fromWire(JSON.parse(await file.text())) }
  }, [example])
  const credit = text.credits[example.name]
  return (
    <li>
      <button type="button" class="pick" onClick={() => mayLeave(studio) && studio.opener.openExample(example)}>
        <span class="pick-photo">
          <img ref={photo} src={example.photo} alt="" decoding="async" />
          {drawn && <SheetPicture {...drawn} />}
        </span>
        <span class="pick-name">{text.examples[example.name] ?? example.name}</span>
      </button>
      {credit && <small class="credit">{text.welcome.credit(...credit)}</small>}
    </li>
  )
}

/** A bundled tree that is drawn from two sides. */
export function SketchCard({ example }: { readonly example: SketchExample }) {
  const studio = useStudio()
  const areImages = example.front.endsWith('.png')
  return (
    <li>
      <button type="button" class="pick" onClick={() => mayLeave(studio) && studio.opener.openSketches(example)}>
        <span class={areImages ? 'pick-photo on-paper of-pictures' : 'pick-photo on-paper'}>
          {areImages ? <Images example={example} /> : <Lines example={example} />}
        </span>
        <span class="pick-name">{text.examples[example.name] ?? example.name}</span>
      </button>
    </li>
  )
}

function Images({ example: { front, side } }: { readonly example: SketchExample }) {
  return (
    <>
      <img src={front} alt="" decoding="async" />
      {side && <img src={side} alt="" decoding="async" />}
    </>
  )
}

function Lines({ example: { front, side } }: { readonly example: SketchExample }) {
  const { client } = useStudio()
  const drawn = useLoaded(async () => {
    const [ahead, left] = await Promise.all([sketchAt(front, client), side ? sketchAt(side, client) : null])
    return { front: ahead.size, strokes: pairSketches(ahead, left).strokes, side: left?.size ?? null }
  }, [front, side])
  return drawn && <PairPicture {...drawn} />
}

async function sketchAt(url: string, client: Client) {
  const file = await client.getFile(url)
  return sketchFrom(JSON.parse(await file.text()))
}
