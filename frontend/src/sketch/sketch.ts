import type { TraceAnswer } from '../api/types'
import { type Extent, photoDrawnOn } from '../sheets'
import type { Selection, Sheet, State, Store } from '../state'
import type { Line, Point, SheetName } from '../strokes'
import { isOfPhotos } from '../tracedOn'
import { Camera } from './camera'
import { AT_REST, type DrawnKind, type GestureEvent, type Intent, interpret, type PointerKind } from './gesture'
import { type KeyCommand, keyCommand, stepFrom } from './keys'
import { PenLine } from './penLine'
import { otherEnd, pick } from './pick'
import { listenToPointers, listenToSpace } from './pointing'
import { Scene, type SketchStatus } from './scene'
import { extentOf, type SheetView, toPageSelection, viewOf } from './sheetView'
import './sketch.css'
import type { SketchEvents, SketchLabels } from './sketchEvents'
import { toScreen, toSheet, type View, within } from './viewport'

/** The least distance between a stroke's points, CSS px. */
const POINT_SPACING = 0.7
/** How far from a click something may lie to be selected, CSS px. */
const CLICK_TOLERANCE: Record<PointerKind, number> = { mouse: 10, pen: 10, touch: 20 }
/** How far from an end of the measured line a press may lie to move it, CSS px. */
const END_TOLERANCE = 14

/** The canvas on which a person draws over a photo or on paper. */
export class Sketch {
  readonly #element = document.createElement('div')
  readonly #camera = new Camera(view => this.#viewChanged(view))
  readonly #scene = new Scene(
    this.#element,
    () => this.#status,
    () => this.#shown,
  )
  readonly #resizing = new ResizeObserver(() => this.#resize())
  readonly #listening = new AbortController()
  readonly #unwatch: () => void
  readonly #name: SheetName
  #state: State
  #shown: SheetView
  #gesture = AT_REST
  /** The stroke that is being drawn. */
  #pen: PenLine | null = null
  /** The keyboard's cursor, sheet px. */
  #cursor: Point | null = null
  #hovered: Selection | null = null
  /** Whether the pointer is over an end of the measured line, which can be moved. */
  #overLineEnd = false
  /** What was traced in the photo before this one; it is not shown. */
  #staleTrace: TraceAnswer | null = null

  constructor(
    host: HTMLElement,
    store: Store,
    private readonly events: SketchEvents,
    name: SheetName,
  ) {
    this.#name = name
    this.#state = store.state
    this.#shown = viewOf(store.state, name)
    this.#element.dataset.sheet = name
    this.#element.className = 'sketch-surface'
    this.#element.tabIndex = 0
    this.#element.role = 'application'
    host.prepend(this.#element)
    this.#listen()
    this.#resizing.observe(this.#element)
    this.#openSheet()
    this.#resize()
    // An earlier listener may have changed the state again: the newest one counts.
    this.#unwatch = store.watch(
      state => state,
      () => this.#stateChanged(store.state),
    )
  }

  /** Remove the sketch from the page. */
  end(): void {
    this.#unwatch()
    this.#resizing.disconnect()
    this.#listening.abort()
    this.#element.remove()
  }

  focus(): void {
    this.#element.focus({ preventScroll: true })
  }

  /** Show the whole sheet. */
  fit(): void {
    this.#camera.fit()
  }

  /** Show one sheet px as one CSS px. */
  actual(): void {
    this.#camera.actual()
  }

  /** Scale by a factor about the middle of the window. */
  zoom(factor: number): void {
    this.#camera.zoom(factor)
  }

  /** Take over the scale and vertical offset (CSS px) of the other sheet's view; `whole` if that one is fitted. */
  follow(view: Pick<View, 'scale' | 'y'>, whole: boolean): void {
    this.#camera.follow(view, whole)
  }

  /** Set what screen readers say: what is drawn on, and how to draw by keyboard. */
  name({ canvas, keys }: SketchLabels): void {
    this.#element.ariaLabel = canvas
    this.#element.setAttribute('aria-description', keys)
  }

  #listen(): void {
    const gesture = (event: GestureEvent) => this.#onGesture(event)
    const tool = (at: Point) => (this.#shown.tool === 'select' && this.#otherEndAt(at) ? 'scale' : this.#shown.tool)
    const wheel = (intent: Intent) => this.#perform(intent)
    listenToPointers(this.#element, { tool, gesture, wheel, hover: at => this.#onHover(at) })
    listenToSpace(this.#element, held => this.#onGesture({ type: 'space', held }), this.#listening.signal)
    this.#element.addEventListener('pointerdown', () => this.events.touched())
    this.#element.addEventListener('keydown', event => this.#onKey(event))
    this.#element.addEventListener('focus', () => this.#onFocus())
    this.#element.addEventListener('blur', () => this.#scene.layers.invalidate('pen'))
  }

  /** Show the cursor where the focus came by keyboard. */
  #onFocus(): void {
    const { sheet } = this.#shown
    if (sheet && this.#element.matches(':focus-visible')) this.#cursor ??= this.#middleOfWindow(sheet)
    this.#scene.layers.invalidate('pen')
    this.events.touched()
  }

  #resize(): void {
    const { clientWidth: width, clientHeight: height } = this.#element
    this.#camera.resize({ width, height })
    this.#scene.layers.resize({ width, height }, window.devicePixelRatio)
  }

  #viewChanged({ scale, x, y }: View): void {
    this.#element.dataset.view = [scale, x, y].join(',')
    this.#scene.layers.invalidateAll()
    this.events.looked({ scale, x, y }, this.#camera.isWhole)
  }

  #stateChanged(now: State): void {
    const [before, shown] = [this.#state, this.#shown]
    this.#state = now
    this.#shown = viewOf(now, this.#name)
    this.#updateSheet(shown.sheet, before)
    if (this.#shown.tool !== shown.tool) this.#cancelStroke()
    if (now.history !== before.history || now.traced !== before.traced) this.#hovered = null
    this.#element.classList.toggle('sketch-stale', now.traced !== null && now.traced.of !== now.history.present)
    this.#scene.layers.invalidate('strokes')
    if (now.traced !== before.traced || now.history !== before.history) this.#scene.layers.invalidate('traced')
    this.#updatePointer()
  }

  /** Show the sheet as it is now: the same one with another picture, or another sheet. */
  #updateSheet(old: Sheet | null, before: State): void {
    const { sheet } = this.#shown
    const { sheets, traced } = this.#state
    this.#element.classList.toggle('sketch-paper', this.#shown.isPaper)
    if (sheet && old && sameSize(sheet, old) && sheet.id === old.id) {
      if (sheet !== old) this.#scene.sheet.show(sheet)
      if (sheet !== old) this.#scene.layers.invalidate('photo')
      if (sheets !== before.sheets) this.#camera.setExtent(extentOf(this.#state, this.#name)!)
    } else if (sheet !== old) {
      this.#staleTrace = traced && traced === before.traced && !isOfPhotos(traced.answer) ? traced.answer : null
      this.#openSheet()
    }
    if (sheets?.side !== before.sheets?.side) this.#scene.layers.invalidate('traced')
  }

  #openSheet(): void {
    const { sheet } = this.#shown
    this.#cancelStroke()
    this.#cursor = null
    this.#scene.sheet.show(sheet)
    if (sheet) this.#camera.open(sheet, extentOf(this.#state, this.#name)!)
    this.#scene.layers.invalidateAll()
  }

  #cancelStroke(): void {
    this.#pen = null
    this.#gesture = interpret(this.#gesture, { type: 'escape' }).state
    this.#scene.layers.invalidate('pen')
  }

  get #traced(): TraceAnswer | null {
    const { traced } = this.#shown
    return traced === this.#staleTrace ? null : traced
  }

  #onGesture(event: GestureEvent): void {
    if (!this.#shown.sheet) return
    const { state, intents } = interpret(this.#gesture, event)
    this.#gesture = state
    for (const intent of intents) this.#perform(intent)
    this.#updatePointer()
  }

  #perform(intent: Intent): void {
    const { type } = intent
    if (type === 'pan') this.#camera.pan(intent.by)
    else if (type === 'pinch') this.#pinch(intent)
    else if (type === 'click') this.#selectAt(intent.at, CLICK_TOLERANCE[intent.pointer])
    else if (type === 'begin') this.#beginStroke(intent.kind, intent.at)
    else if (type === 'extend') this.#extendStroke(intent.path)
    else if (type === 'end') this.#finishStroke()
    else this.#dropStroke()
  }

  #pinch({ by, factor, about }: Intent & { type: 'pinch' }): void {
    this.#camera.pan(by)
    this.#camera.zoom(factor, about)
  }

  #beginStroke(kind: DrawnKind, at: Point): void {
    this.#cursor = null
    const { sheet, brush } = this.#shown
    const width = kind === 'branch' ? brush : null
    this.#pen = new PenLine(kind, sheet!, kind === 'scale' ? this.#otherEndAt(at) : null, width)
    this.#extendStroke([at])
  }

  #extendStroke(path: Line): void {
    const { view } = this.#camera
    for (const at of path) this.#pen?.add(toSheet(view, at), POINT_SPACING / view.scale)
    this.#scene.layers.invalidate('pen')
  }

  #finishStroke(): void {
    const pen = this.#pen
    this.#dropStroke()
    const line = pen?.finished()
    if (pen && line) this.events.drew(pen.kind, line)
  }

  #dropStroke(): void {
    this.#pen = null
    this.#scene.layers.invalidate('pen')
  }

  #selectAt(at: Point, tolerance: number): void {
    this.events.selected(toPageSelection(this.#pickAt(at, tolerance), this.#name, photoDrawnOn(this.#state)))
  }

  #pickAt(at: Point, tolerance: number): Selection | null {
    const { view } = this.#camera
    const skeleton = this.#traced?.skeleton ?? null
    return pick(this.#shown.strokes, skeleton, toSheet(view, at), tolerance / view.scale)
  }

  /** Return the other end of the measured line where one end lies at a point of the window (CSS px); else null. */
  #otherEndAt(at: Point): Point | null {
    const { view } = this.#camera
    return otherEnd(this.#shown.strokes, toSheet(view, at), END_TOLERANCE / view.scale)
  }

  #onHover(at: Point | null): void {
    const { sheet, tool } = this.#shown
    const free = sheet && this.#gesture.mode.name === 'idle' ? at : null
    this.#overLineEnd = Boolean(free && (tool === 'select' || tool === 'scale') && this.#otherEndAt(free))
    this.#updatePointer()
    const hovered = free && tool === 'select' ? this.#pickAt(free, CLICK_TOLERANCE.mouse) : null
    if (JSON.stringify(hovered) === JSON.stringify(this.#hovered)) return
    this.#hovered = hovered
    this.#scene.layers.invalidate('strokes')
    this.#updatePointer()
  }

  #updatePointer(): void {
    const { mode, space } = this.#gesture
    const panning = mode.name === 'pinch' || (mode.name === 'pan' && (mode.moved || !mode.mayClick))
    const tool = this.#shown.tool === 'select' ? 'choose' : 'draw'
    const under = this.#overLineEnd ? 'end' : this.#hovered ? 'take' : tool
    this.#element.dataset.pointer = panning ? 'panning' : space ? 'pan' : under
  }

  #onKey(event: KeyboardEvent): void {
    const command = keyCommand(event)
    if (!command || !this.#shown.sheet) return
    event.preventDefault()
    this.#run(command, this.#shown.sheet)
  }

  #run(command: KeyCommand, sheet: Extent): void {
    const { type } = command
    if (type === 'step') this.#moveCursor(command, sheet)
    else if (type === 'pen') this.#pressPenKey(sheet)
    else if (type === 'escape') this.#onEscape()
    else if (type === 'remove') this.events.remove()
    else if (type === 'zoom') this.zoom(command.factor)
    else if (type === 'fit') this.fit()
    else this.actual()
  }

  #moveCursor(step: KeyCommand & { type: 'step' }, sheet: Extent): void {
    const at = this.#cursor ? stepFrom(this.#cursor, step, sheet) : this.#middleOfWindow(sheet)
    this.#cursor = at
    this.#pen?.add(at, 0)
    this.#camera.show(at)
    this.#scene.layers.invalidate('pen')
    this.events.said({ pen: 'move', at })
  }

  #pressPenKey(sheet: Extent): void {
    const at = this.#cursor ?? this.#middleOfWindow(sheet)
    this.#cursor = at
    this.#scene.layers.invalidate('pen')
    const { tool } = this.#shown
    if (tool === 'select') this.#selectAt(toScreen(this.#camera.view, at), CLICK_TOLERANCE.mouse)
    else this.#togglePen(tool, sheet, at)
  }

  #togglePen(kind: DrawnKind, sheet: Extent, at: Point): void {
    if (this.#pen) this.#finishStroke()
    else {
      this.#pen = new PenLine(kind, sheet, null, kind === 'branch' ? this.#shown.brush : null)
      this.#pen.add(at, 0)
    }
    this.events.said({ pen: this.#pen ? 'down' : 'up', at })
  }

  #onEscape(): void {
    if (this.#pen) this.#cancelStroke()
    else if (this.#shown.selection) this.events.selected(null)
  }

  get #status(): SketchStatus {
    const focused = document.activeElement === this.#element
    const { view } = this.#camera
    return { view, traced: this.#traced, hovered: this.#hovered, pen: this.#pen, cursor: focused ? this.#cursor : null }
  }

  /** Return the point of the sheet in the middle of the window, sheet px. */
  #middleOfWindow({ width, height }: Extent): Point {
    const { clientWidth, clientHeight } = this.#element
    const [x, y] = toSheet(this.#camera.view, [clientWidth / 2, clientHeight / 2])
    return [within(x, 0, width), within(y, 0, height)]
  }
}

function sameSize(one: Extent, other: Extent): boolean {
  return one.width === other.width && one.height === other.height
}
