import { useLayoutEffect, useRef } from 'preact/hooks'
import { isPaper, SHEET_NAMES, sheetOf } from '../../sheets'
import type { SheetName } from '../../strokes'
import { useStore } from '../parts/useStore'
import { LengthField } from './LengthField'
import { SheetHeading } from './SheetHeading'
import type { SheetSketches, Views } from './sheetSketches'
import './sheets.css'

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
function SheetPart({ name, sketches, views }: Props & { readonly name: SheetName }) {
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
