import type { ComponentChildren } from 'preact'
import { useLayoutEffect, useRef, useState } from 'preact/hooks'
import { labelPlace } from '../../sketch/lengthLabel'
import { type View, within } from '../../sketch/viewport'
import type { State } from '../../state'
import type { Line, Scale } from '../../strokes'
import { text } from '../../text'
import { IconButton } from '../parts/IconButton'
import { ICONS } from '../parts/icons'
import { numberIn } from '../parts/spans'
import { useStore, useStudio } from '../parts/useStore'
import './lengthField.css'

/** The lengths that can be entered, metres. */
const SPAN = { min: 0.001, max: 1000, whole: false }
/** The least distance between the field and the edge of its sheet, CSS px. */
const MARGIN = 6

interface Props {
  /** The view of its sheet; null before there is one. */
  readonly view: View | null
  /** Move the focus back to the sheet. */
  leave(): void
}

/** The field for the length of the measured line, beside the line while that is selected. */
export function LengthField(props: Props) {
  const { store } = useStudio()
  const scale = useStore(selectedScale)
  const asked = useRef<Line | null>(null)
  const asks = scale !== null && asked.current !== scale.points && isLatest(store.state)
  useLayoutEffect(() => {
    if (scale) asked.current = scale.points
  }, [scale])
  return scale && <LengthInput key={scale.points} {...props} scale={scale} asks={asks} />
}

/** The field itself; where it `asks` for the length of a new line it gets the focus. */
function LengthInput({ view, leave, scale, asks }: Props & { readonly scale: Scale; readonly asks: boolean }) {
  const { strokes } = useStudio()
  const [written, write] = useState(String(scale.metres))
  const [isWrong, setWrong] = useState(false)
  const field = useRef<HTMLInputElement>(null)
  useLayoutEffect(() => {
    write(String(scale.metres))
    setWrong(false)
  }, [scale])
  useLayoutEffect(() => {
    if (asks) field.current!.focus({ preventScroll: true })
    if (asks) field.current!.select()
  }, [])
  const commit = () => {
    const metres = numberIn(field.current!.value.replace(',', '.'), SPAN)
    setWrong(metres === null)
    if (metres !== null) strokes.measure(metres)
    return metres !== null
  }
  const press = (event: KeyboardEvent) => {
    if (event.key !== 'Enter' && event.key !== 'Escape') return
    event.preventDefault()
    if (event.key === 'Enter' && !commit()) return
    field.current!.value = String(scale.metres) // else leaving the field would commit what was typed
    strokes.select(null)
    leave()
  }
  return (
    <BesideLine scale={scale} view={view}>
      <div>
        <input
          type="text"
          inputMode="decimal"
          autocomplete="off"
          aria-label={text.length.field}
          aria-invalid={isWrong}
          value={written}
          onInput={event => write(event.currentTarget.value)}
          onChange={commit}
          onKeyDown={press}
          ref={field}
        />
        <span aria-hidden="true">{text.length.unit}</span>
        <IconButton label={text.length.delete} icon={ICONS.remove} onClick={() => strokes.remove()} />
      </div>
      <p class="length-wrong" role="alert">
        {isWrong && text.length.wrong(SPAN.min, SPAN.max)}
      </p>
    </BesideLine>
  )
}

interface BesideProps {
  readonly scale: Scale
  readonly view: View | null
  readonly children: ComponentChildren
}

/** A box that stays beside the measured line when the sheet is moved. */
function BesideLine({ scale, view, children }: BesideProps) {
  const element = useRef<HTMLDivElement>(null)
  useLayoutEffect(() => {
    if (view) placeAt(element.current!, scale, view)
  }, [scale, view])
  return (
    <div class="length-field" ref={element}>
      {children}
    </div>
  )
}

function selectedScale({ selection, history }: State): Scale | null {
  return selection?.kind === 'scale' ? history.present.scale : null
}

/** Whether the measured line was drawn last, so that its length is asked for. */
function isLatest({ history }: State): boolean {
  const before = history.past.at(-1)
  return before !== undefined && before.scale?.points !== history.present.scale?.points
}

function placeAt(element: HTMLElement, { points }: Scale, view: View): void {
  const room = element.parentElement
  if (!room) return
  const { offsetWidth: width, offsetHeight: height } = element
  const [x, y] = labelPlace(points, view, { width, height })
  const inside = (middle: number, size: number, most: number) =>
    within(middle - size / 2, MARGIN, Math.max(MARGIN, most - size - MARGIN))
  element.style.left = `${inside(x, width, room.clientWidth)}px`
  element.style.top = `${inside(y, height, room.clientHeight)}px`
}
