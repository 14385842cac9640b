import type { RefObject } from 'preact'
import { useLayoutEffect, useRef, useState } from 'preact/hooks'
import { captureOf, clipOf } from '../../sheets'
import type { SheetName } from '../../strokes'
import { text } from '../../text'
import { useFilm } from '../film/useFilm'
import { useStore, useStudio } from '../parts/useStore'
import { TreePane } from '../tree/TreePane'
import { announceDrawing } from './announcements'
import { DrawingPane } from './DrawingPane'
import './workspace.css'

type Shown = 'drawing' | 'both' | 'tree'
/** What the switch on a phone offers, with one sheet and with two. */
type Choice = Shown | SheetName
const ONE_SHEET: readonly Choice[] = ['drawing', 'both', 'tree']
const TWO_SHEETS: readonly Choice[] = ['front', 'side', 'tree']
const LABELS: Readonly<Record<Choice, string>> = {
  drawing: text.workspace.drawing,
  both: text.workspace.both,
  ...text.sheets.tabs,
}

/** The drawing's share of the width, per cent; the first is also in the stylesheet. */
const SPLIT = 55
const MIN_SPLIT = 30
const MAX_SPLIT = 75
const SPLIT_STEP = 5

/** The drawing beside the tree; hidden, not removed, while nothing is open. */
export function Workspace() {
  const { store } = useStudio()
  const isOpen = useStore(({ sheets }) => sheets !== null)
  const hasSide = useStore(({ sheets }) => Boolean(sheets?.side))
  const hasStrip = useStore(state => captureOf(state) !== null || clipOf(state) !== null)
  const [shown, show] = useShown(hasSide || hasStrip)
  const filmed = useFilm()
  const [split, setSplit] = useState<number | null>(null)
  const element = useRef<HTMLDivElement>(null)
  useLayoutEffect(() => announceDrawing(store), [store])
  useFocusOnOpening(element, isOpen)
  return (
    <div
      class={hasSide ? 'workspace two-sheets' : 'workspace'}
      data-shows={shown}
      hidden={!isOpen}
      style={split === null ? {} : { '--split': `${split}%` }}
      ref={element}
    >
      <section class="pane drawing-pane" aria-label={text.workspace.drawing}>
        <DrawingPane filmed={filmed} />
      </section>
      <Divider split={split} move={setSplit} />
      <PaneChooser shown={shown} hasSide={hasSide} show={show} />
      <section class="pane tree-pane" aria-label={text.workspace.tree}>
        <TreePane filmed={filmed} />
      </section>
    </div>
  )
}

/** Return what a phone shows, and how to set it: two sheets, or a strip of photos, leave no room for the tree until one is grown. */
function useShown(isFull: boolean): [Shown, (shown: Shown) => void] {
  const [shown, show] = useState<Shown>('both')
  const isAsked = useStore(({ asking }) => asking) && isFull
  useLayoutEffect(() => show(isFull ? 'drawing' : 'both'), [isFull])
  useLayoutEffect(() => {
    if (isAsked) show('tree')
  }, [isAsked])
  return [shown, show]
}

/** Move the focus to the sheet or back to the page when a drawing is opened or closed, as what was clicked is gone. */
function useFocusOnOpening(workspace: RefObject<HTMLElement | null>, isOpen: boolean): void {
  const wasOpen = useRef(isOpen)
  useLayoutEffect(() => {
    if (isOpen === wasOpen.current) return
    wasOpen.current = isOpen
    const place = isOpen ? workspace.current!.querySelector('.canvas > *') : workspace.current!.closest('main')
    ;(place as HTMLElement | null)?.focus({ preventScroll: true })
  }, [isOpen])
}

interface ChooserProps {
  readonly shown: Shown
  readonly hasSide: boolean
  show(shown: Shown): void
}

/** The switch for what a phone shows. */
function PaneChooser({ shown, hasSide, show }: ChooserProps) {
  const { sheets } = useStudio()
  const active = useStore(state => state.active)
  const [choices, chosen] = hasSide ? [TWO_SHEETS, shown === 'tree' ? 'tree' : active] : [ONE_SHEET, shown]
  const choose = (choice: Choice) => {
    const isSheet = choice === 'front' || choice === 'side'
    if (isSheet) sheets.activate(choice)
    show(isSheet ? 'drawing' : choice)
  }
  return (
    <div class="chooser" role="group" aria-label={text.workspace.show}>
      {choices.map(choice => (
        <button
          type="button"
          class="button"
          key={choice}
          data-show={choice}
          aria-pressed={choice === chosen}
          onClick={() => choose(choice)}
        >
          {LABELS[choice]}
        </button>
      ))}
    </div>
  )
}

interface DividerProps {
  /** The share of the first pane, per cent; null until it is moved. */
  readonly split: number | null
  move(split: number): void
}

/** The handle that sets the width of the two panes. */
function Divider({ split, move }: DividerProps) {
  const now = split ?? SPLIT
  const moveTo = (wanted: number) => move(Math.min(MAX_SPLIT, Math.max(MIN_SPLIT, wanted)))
  const drag = (event: PointerEvent) => {
    const handle = event.currentTarget as HTMLElement
    const { left, width } = handle.parentElement!.getBoundingClientRect()
    if (handle.hasPointerCapture(event.pointerId)) moveTo(((event.clientX - left) / width) * 100)
  }
  const press = ({ key }: KeyboardEvent) => {
    const step = { ArrowLeft: -SPLIT_STEP, ArrowRight: SPLIT_STEP }[key]
    if (step) moveTo(now + step)
  }
  return (
    <div
      class="divider"
      role="separator"
      tabIndex={0}
      aria-orientation="vertical"
      aria-label={text.workspace.divider}
      aria-valuemin={MIN_SPLIT}
      aria-valuemax={MAX_SPLIT}
      aria-valuenow={Math.round(now)}
      onPointerDown={event => event.currentTarget.setPointerCapture(event.pointerId)}
      onPointerMove={drag}
      onKeyDown={press}
    />
  )
}
