import { useLayoutEffect, useRef } from 'preact/hooks'
import { isPaper, SHEET_NAMES, sheetOf } from '../../sheets'
import type { SheetName } from '../../strokes'
import { text } from '../../text'
import { choosePicture, chooseSketch } from '../parts/files'
import { IconButton } from '../parts/IconButton'
import { ICONS } from '../parts/icons'
import { useStore, useStudio } from '../parts/useStore'
import { LengthField } from './LengthField'
import type { SheetSketches, Views } from './sheetSketches'
import './sheets.css'

const { sheets: words } = text

interface Named {
  readonly name: SheetName
}

interface Props {
  readonly sketches: SheetSketches
  readonly views: Views
}

/** The sheets of the front and of the left side, side by side. */
export function Sheets({ sketches, views }: Props) {
  const active = useStore(state => state.active)
  return (
    <div class="sheets" data-active={active}>
      {SHEET_NAMES.map(name => (
        <SheetPart key={name} name={name} sketches={sketches} views={views} />
      ))}
    </div>
  )
}

/** One sheet under its heading; lengths are measured on the front only. */
function SheetPart({ name, sketches, views }: Props & Named) {
  const isClosed = useStore(state => sheetOf(state, name) === null)
  const onPaper = useStore(state => isPaper(state, name))
  const canvas = useRef<HTMLDivElement>(null)
  useLayoutEffect(() => sketches.add(name, canvas.current!), [sketches])
  useLayoutEffect(() => sketches.label(name), [sketches, onPaper])
  return (
    <div class="sheet-part" data-of={name} hidden={isClosed && name === 'side'}>
      <SheetHeading name={name} />
      <div class="canvas" ref={canvas}>
        {name === 'front' && <LengthField view={views.front ?? null} leave={() => sketches.focus(name)} />}
      </div>
    </div>
  )
}

/** A sheet's heading: its name, the direction of view, and the buttons for its picture. */
function SheetHeading({ name }: Named) {
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

function SheetTools({ name }: Named) {
  const { sheets, opener } = useStudio()
  const sheet = useStore(state => sheetOf(state, name))
  const onPaper = useStore(state => isPaper(state, name))
  const hasPicture = Boolean(sheet?.url)
  const isHidden = Boolean(sheet?.hidden)
  const tools = useRef<HTMLDivElement>(null)
  // Found before the buttons of the picture change: one that is hidden has lost the focus at once.
  const hasFocus = tools.current?.contains(document.activeElement)
  useLayoutEffect(() => {
    if (hasFocus) tools.current!.querySelector<HTMLElement>('.of-picture:not([hidden])')?.focus()
  }, [hasPicture])
  return (
    <div class="sheet-tools" ref={tools}>
      <IconButton
        label={words.openDrawing}
        icon={ICONS.drawing}
        hidden={!onPaper}
        onClick={() => chooseSketch(file => void opener.openOn(name, file))}
      />
      <IconButton
        class="of-picture"
        label={words.addPicture}
        icon={ICONS.photo}
        hidden={!onPaper || hasPicture}
        onClick={() => choosePicture(file => void sheets.addPicture(name, file))}
      />
      <IconButton
        class="of-picture"
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
function Compass({ name }: Named) {
  const eye = name === 'front' ? 'M12 22.5 9 18h6zM12 18v-2.5' : 'M1.5 12 6 9v6zM6 12h2.5'
  return (
    <svg viewBox="0 0 24 24" class="icon compass" aria-hidden="true">
      <circle cx={12} cy={12} r={4.5} />
      <path class="compass-eye" d={eye} />
    </svg>
  )
}
