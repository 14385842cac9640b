import { useState } from 'preact/hooks'
import { outlineOf } from '../../outlineOf'
import type { Line } from '../../strokes'
import { text } from '../../text'
import { choosePicture } from '../parts/files'
import { RadioButtons } from '../parts/RadioButtons'
import { OutlinePad } from './OutlinePad'

const { siblings: words } = text
const NAMES = ['none', 'heart', 'triangle', 'circle', 'pentagon', 'drawn', 'picture'] as const
/** The longer side of the copy in which a picture's shape is looked for, px. */
const SIDE = 256

export type OutlineName = (typeof NAMES)[number]

interface Props {
  readonly shape: OutlineName
  choose(shape: OutlineName): void
  /** What was drawn, or found in a picture. */
  readonly drawn: Line | null
  draw(outline: Line | null): void
}

/** The outline that siblings fill: the tree's own, a shape by its name, one drawn by hand, or that of a picture. */
export function OutlineField({ shape, choose, drawn, draw }: Props) {
  const change = (name: string) => {
    choose(name as OutlineName)
    draw(null)
  }
  return (
    <fieldset class="outline-field">
      <legend>{words.outline}</legend>
      <RadioButtons
        label={words.outline}
        choices={NAMES.map(name => [name, words.outlines[name]])}
        chosen={shape}
        choose={change}
      />
      {shape === 'drawn' && <OutlinePad outline={drawn} draw={draw} />}
      {shape === 'picture' && <PictureField outline={drawn} draw={draw} />}
    </fieldset>
  )
}

function PictureField({ outline, draw }: { readonly outline: Line | null } & Pick<Props, 'draw'>) {
  const [isBad, setBad] = useState(false)
  const take = async (file: File) => {
    const found = await pixelsOf(file).then(outlineOf, () => null)
    setBad(found === null)
    draw(found)
  }
  return (
    <div class="outline-picture">
      <button type="button" class="button outlined" onClick={() => choosePicture(file => void take(file))}>
        {words.choosePicture}
      </button>
      {isBad ? (
        <p class="fault" role="alert">
          {words.pictureUnreadable}
        </p>
      ) : (
        <p class="soft">{words.pictureHint}</p>
      )}
      {outline && <OutlinePad outline={outline} />}
    </div>
  )
}

/** Return a picture's pixels, in a small copy. */
async function pixelsOf(file: Blob): Promise<ImageData> {
  const picture = await createImageBitmap(file)
  const factor = Math.min(1, SIDE / Math.max(picture.width, picture.height))
  const [width, height] = [picture.width, picture.height].map(side => Math.max(1, Math.round(side * factor)))
  const ctx = new OffscreenCanvas(width!, height!).getContext('2d')!
  ctx.drawImage(picture, 0, 0, width!, height!)
  picture.close()
  return ctx.getImageData(0, 0, width!, height!)
}
