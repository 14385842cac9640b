import { isPaper, sheetOf } from '../../sheets'
import type { SheetName } from '../../strokes'
import { text } from '../../text'
import { choosePicture, chooseSketch } from '../parts/files'
import { IconButton } from '../parts/IconButton'
import { ICONS } from '../parts/icons'
import { useStore, useStudio } from '../parts/useStore'

const { sheets: words } = text

interface Props {
  readonly name: SheetName
}

/** A sheet's heading: its name, the direction of view, and the buttons for its picture. */
export function SheetHeading({ name }: Props) {
  const isShown = useStore(({ sheets }) => sheets?.source === 'sketch' || Boolean(sheets?.side))
  const isActive = useStore(({ active }) => active === name)
  return (
    <div class={isActive ? 'sheet-heading active' : 'sheet-heading'} hidden={!isShown}>
      <Compass name={name} />
      <h2 title={words.seenLong[name]}>{words[name]}</h2>
      <p class="soft" title={words.seenLong[name]}>
        {words.seen[name]}
      </p>
      <SheetTools name={name} />
    </div>
  )
}

function SheetTools({ name }: Props) {
  const { sheets, opener } = useStudio()
  const sheet = useStore(state => sheetOf(state, name))
  const onPaper = useStore(state => isPaper(state, name))
  const hasPicture = Boolean(sheet?.url)
  const isHidden = Boolean(sheet?.hidden)
  return (
    <div class="sheet-tools">
      <IconButton
        label={words.openDrawing}
        icon={ICONS.drawing}
        hidden={!onPaper}
        onClick={() => chooseSketch(file => void opener.openOn(name, file))}
      />
      <IconButton
        label={words.addPicture}
        icon={ICONS.photo}
        hidden={!onPaper || hasPicture}
        onClick={() => choosePicture(file => void sheets.addPicture(name, file))}
      />
      <IconButton
        label={isHidden ? words.show : words.hide}
        icon={ICONS.eye}
        hidden={!onPaper || !hasPicture}
        aria-pressed={!isHidden}
        onClick={() => sheets.showPicture(name, isHidden)}
      />
      <IconButton
        label={words.removePicture}
        icon={ICONS.remove}
        hidden={!onPaper || !hasPicture}
        onClick={() => sheets.removePicture(name)}
      />
      <IconButton label={words.close} icon={ICONS.cross} hidden={name === 'front'} onClick={() => sheets.closeSide()} />
    </div>
  )
}

/** A plan of the tree with the viewer: below it for the front, left of it for the side. */
function Compass({ name }: Props) {
  const eye = name === 'front' ? 'M12 22.5 9 18h6zM12 18v-2.5' : 'M1.5 12 6 9v6zM6 12h2.5'
  return (
    <svg viewBox="0 0 24 24" class="icon compass" aria-hidden="true">
      <circle cx={12} cy={12} r={4.5} />
      <path class="compass-eye" d={eye} />
    </svg>
  )
}
