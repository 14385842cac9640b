import { useLayoutEffect, useRef } from 'preact/hooks'
import { remarksOn } from '../../doubts'
import { lineOf, type StrokeRef, strokeRefs } from '../../strokes'
import { text } from '../../text'
import { Icon } from '../parts/Icon'
import { IconButton } from '../parts/IconButton'
import { ICONS } from '../parts/icons'
import { Popover } from '../parts/Popover'
import { useStore, useStudio } from '../parts/useStore'
import { remarkText, strokeName } from './strokeTexts'
import './strokeList.css'

/** The button that opens the list of all strokes, and the list. */
export function StrokeList() {
  const strokes = useStore(({ history }) => history.present)
  const refs = strokeRefs(strokes)
  const label = text.strokes.button(refs.length)
  const opener = { class: 'button tool', title: label, 'aria-label': label, children: <Icon path={ICONS.list} /> }
  return (
    <Popover opener={opener} label={text.strokes.title}>
      <h2 class="stroke-title">{text.strokes.title}</h2>
      <StrokeRows refs={refs} />
    </Popover>
  )
}

/** One row for each stroke; the focus moves to a neighbour when its row is removed. */
function StrokeRows({ refs }: { readonly refs: readonly StrokeRef[] }) {
  const strokes = useStore(({ history }) => history.present)
  const list = useRef<HTMLUListElement>(null)
  // Found before the rows change: a row that is removed loses the focus.
  const focused = [...(list.current?.children ?? [])].findIndex(row => row.contains(document.activeElement))
  useLayoutEffect(() => {
    if (focused < 0 || list.current!.contains(document.activeElement)) return
    const row = list.current!.children[Math.min(focused, list.current!.children.length - 1)]
    ;(row?.querySelector('button') ?? list.current!).focus()
  })
  return (
    <ul class="stroke-rows" tabIndex={-1} ref={list}>
      {refs.map(ref => (
        <StrokeRow key={lineOf(strokes, ref)} stroke={ref} />
      ))}
      {refs.length === 0 && <li class="stroke-empty">{text.strokes.none}</li>}
    </ul>
  )
}

function StrokeRow({ stroke }: { readonly stroke: StrokeRef }) {
  const { strokes, captures } = useStudio()
  const history = useStore(state => state.history)
  const traced = useStore(state => state.traced)
  const selection = useStore(state => state.selection)
  const name = strokeName(stroke)
  const remarks = remarksOn({ history, traced }).filter(remark => remark.stroke && isSame(remark.stroke, stroke))
  const isChosen = selection !== null && selection.kind !== 'traced' && isSame(selection, stroke)
  const { scale } = history.present
  const choose = () => {
    if (stroke.photo !== undefined) captures.choose(stroke.photo)
    strokes.select(isChosen ? null : stroke)
  }
  const remove = () => {
    strokes.select(stroke)
    strokes.remove()
  }
  return (
    <li class="stroke-row" data-kind={stroke.kind}>
      <button type="button" class="button stroke-name" aria-pressed={isChosen} onClick={choose}>
        {stroke.kind === 'scale' && scale ? text.strokes.scaleOf(text.metres(scale.metres)) : name}
      </button>
      <IconButton label={text.strokes.delete(name)} icon={ICONS.remove} onClick={remove} />
      {remarks.map(remark => (
        <p class="stroke-remark" key={remark.warning.code}>
          {remarkText(remark)}
        </p>
      ))}
    </li>
  )
}

function isSame(one: StrokeRef, other: StrokeRef): boolean {
  return one.kind === other.kind && one.index === other.index && one.sheet === other.sheet && one.photo === other.photo
}
