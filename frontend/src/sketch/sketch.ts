import type { TraceAnswer } from '../api/types'
import type { Extent } from '../sheets'
import type { Selection, Sheet, State, Store } from '../state'
import type { Line, Point, SheetName } from '../strokes'
import { Camera } from './camera'
import { AT_REST, type DrawnKind, type GestureEvent, gestured, type Intent, type PointerKind } from './gesture'
import { type KeyCommand, keyCommand, stepped } from './keys'
import { PenLine } from './penLine'
import { otherEnd, pick } from './pick'
import { listenToPointers, listenToSpace } from './pointing'
import { Scene, type SketchStatus } from './scene'
import { extentOf, ofSheet, type SheetView, viewOf } from './sheetView'
import './sketch.css'
import type { SketchEvents, SketchLabels } from './sketchEvents'
import { toPhoto, toScreen, type View, within } from './viewport'

/** Points of a stroke are as far apart at least, CSS px. */
const APART = 0.7
/** A click takes what lies as near, CSS px. */
const REACH: Record<PointerKind, number> = { mouse: 10, pen: 10, touch: 20 }
/** A press as near to an end of the measured line moves it, CSS px. */
const END_REACH = 14

/** The canvas over the photo, or of paper, that a person draws on. */
export class Sketch {
  readonly #element = document.createElement('div')
  readonly #camera = new Camera(view => this.#looked(view))
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
  #pen: PenLine | null = null
  /** The keyboard's pen, photo px. */
  #aim: Point | null = null
  #hovered: Selection | null = null
  /** The pointer is over an end of the measured line, which can be moved. */
  #overEnd = false
  /** What was traced of a photo that is gone. */
  #foreign: TraceAnswer | null = null

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
    this.#open()
    this.#resize()
    // A listener before this one may have gone on to a newer state already.
    this.#unwatch = store.watch(
      state => state,
      () => this.#changed(store.state),
    )
  }

  /** Remove the canvas, and stop listening. */
  end(): void {
    this.#unwatch()
    this.#resizing.disconnect()
    this.#listening.abort()
    this.#element.remove()
  }

  focus(): void {
    this.#element.focus({ preventScroll: true })
  }

  fit(): void {
    this.#camera.fit()
  }

  /** Show one photo px as one CSS px. */
  actual(): void {
    this.#camera.actual()
  }

  /** Scale about the middle. */
  zoom(factor: number): void {
    this.#camera.zoom(factor)
  }

  /** Look as high up, and at the scale, that another sheet is looked at: as if it were as high as this one. */
  follow(view: Pick<View, 'scale' | 'y'>, whole: boolean): void {
    this.#camera.follow(view, whole)
  }

  /** Say what is drawn on, and how to do it by keyboard. */
  name({ canvas, keys }: SketchLabels): void {
    this.#element.ariaLabel = canvas
    this.#element.setAttribute('aria-description', keys)
  }

  #listen(): void {
    const gesture = (event: GestureEvent) => this.#gestured(event)
    const tool = (at: Point) => (this.#shown.tool === 'select' && this.#otherEnd(at) ? 'scale' : this.#shown.tool)
    const wheel = (intent: Intent) => this.#do(intent)
    listenToPointers(this.#element, { tool, gesture, wheel, hover: at => this.#hover(at) })
    listenToSpace(this.#element, held => this.#gestured({ type: 'space', held }), this.#listening.signal)
    this.#element.addEventListener('pointerdown', () => this.events.touched())
    this.#element.addEventListener('keydown', event => this.#pressed(event))
    this.#element.addEventListener('focus', () => this.#focused())
    this.#element.addEventListener('blur', () => this.#scene.layers.touch('pen'))
  }

  /** Who comes by keyboard sees where the pen is. */
  #focused(): void {
    const { sheet } = this.#shown
    if (sheet && this.#element.matches(':focus-visible')) this.#aim ??= this.#middle(sheet)
    this.#scene.layers.touch('pen')
    this.events.touched()
  }

  #resize(): void {
    const { clientWidth: width, clientHeight: height } = this.#element
    this.#camera.resize({ width, height })
    this.#scene.layers.resize({ width, height }, window.devicePixelRatio)
  }

  #looked({ scale, x, y }: View): void {
    this.#element.dataset.view = [scale, x, y].join(',')
    this.#scene.layers.touchAll()
    this.events.looked({ scale, x, y }, this.#camera.isWhole)
  }

  #changed(now: State): void {
    const [before, shown] = [this.#state, this.#shown]
    this.#state = now
    this.#shown = viewOf(now, this.#name)
    this.#relay(shown.sheet, before)
    if (this.#shown.tool !== shown.tool) this.#putAway()
    if (now.history !== before.history || now.traced !== before.traced) this.#hovered = null
    this.#element.classList.toggle('sketch-stale', now.traced !== null && now.traced.of !== now.history.present)
    this.#scene.layers.touch('strokes')
    if (now.traced !== before.traced || now.history !== before.history) this.#scene.layers.touch('traced')
    this.#pointAt()
  }

  /** Bring what lies under the strokes into step. */
  #relay(was: Sheet | null, before: State): void {
    const { sheet } = this.#shown
    const { sheets, traced } = this.#state
    this.#element.classList.toggle('sketch-paper', this.#shown.isPaper)
    if (sheet && was && sameSize(sheet, was) && sheet.id === was.id) {
      if (sheet !== was) this.#scene.picture.show(sheet)
      if (sheet !== was) this.#scene.layers.touch('photo')
      if (sheets !== before.sheets) this.#camera.reach(extentOf(this.#state, this.#name)!)
    } else if (sheet !== was) {
      this.#foreign = traced === before.traced ? (traced?.answer ?? null) : null
      this.#open()
    }
    if (sheets?.side !== before.sheets?.side) this.#scene.layers.touch('traced')
  }

  #open(): void {
    const { sheet } = this.#shown
    this.#putAway()
    this.#aim = null
    this.#scene.picture.show(sheet)
    if (sheet) this.#camera.open(sheet, extentOf(this.#state, this.#name)!)
    this.#scene.layers.touchAll()
  }

  #putAway(): void {
    this.#pen = null
    this.#gesture = gestured(this.#gesture, { type: 'escape' }).state
    this.#scene.layers.touch('pen')
  }

  get #traced(): TraceAnswer | null {
    const { traced } = this.#shown
    return traced === this.#foreign ? null : traced
  }

  #gestured(event: GestureEvent): void {
    if (!this.#shown.sheet) return
    const { state, intents } = gestured(this.#gesture, event)
    this.#gesture = state
    for (const intent of intents) this.#do(intent)
    this.#pointAt()
  }

  #do(intent: Intent): void {
    const { type } = intent
    if (type === 'pan') this.#camera.pan(intent.by)
    else if (type === 'pinch') this.#pinch(intent)
    else if (type === 'click') this.#select(intent.at, REACH[intent.pointer])
    else if (type === 'begin') this.#begin(intent.kind, intent.at)
    else if (type === 'extend') this.#extend(intent.path)
    else if (type === 'end') this.#finish()
    else this.#drop()
  }

  #pinch({ by, factor, about }: Intent & { type: 'pinch' }): void {
    this.#camera.pan(by)
    this.#camera.zoom(factor, about)
  }

  #begin(kind: DrawnKind, at: Point): void {
    this.#aim = null
    const { sheet, brush } = this.#shown
    const width = kind === 'branch' ? brush : null
    this.#pen = new PenLine(kind, sheet!, kind === 'scale' ? this.#otherEnd(at) : null, width)
    this.#extend([at])
  }

  #extend(path: Line): void {
    const { view } = this.#camera
    for (const at of path) this.#pen?.add(toPhoto(view, at), APART / view.scale)
    this.#scene.layers.touch('pen')
  }

  #finish(): void {
    const pen = this.#pen
    this.#drop()
    const line = pen?.finished()
    if (pen && line) this.events.drew(pen.kind, line)
  }

  #drop(): void {
    this.#pen = null
    this.#scene.layers.touch('pen')
  }

  #select(at: Point, reach: number): void {
    this.events.selected(ofSheet(this.#pick(at, reach), this.#name))
  }

  #pick(at: Point, reach: number): Selection | null {
    const { view } = this.#camera
    const skeleton = this.#traced?.skeleton ?? null
    return pick(this.#shown.strokes, skeleton, toPhoto(view, at), reach / view.scale)
  }

  /** The end that stays where the one at a place in the window is moved. */
  #otherEnd(at: Point): Point | null {
    const { view } = this.#camera
    return otherEnd(this.#shown.strokes, toPhoto(view, at), END_REACH / view.scale)
  }

  #hover(at: Point | null): void {
    const { sheet, tool } = this.#shown
    const free = sheet && this.#gesture.mode.name === 'idle' ? at : null
    this.#overEnd = Boolean(free && (tool === 'select' || tool === 'scale') && this.#otherEnd(free))
    this.#pointAt()
    const hovered = free && tool === 'select' ? this.#pick(free, REACH.mouse) : null
    if (JSON.stringify(hovered) === JSON.stringify(this.#hovered)) return
    this.#hovered = hovered
    this.#scene.layers.touch('strokes')
    this.#pointAt()
  }

  #pointAt(): void {
    const { mode, space } = this.#gesture
    const panning = mode.name === 'pinch' || (mode.name === 'pan' && (mode.far || !mode.clicks))
    const choosing = this.#overEnd ? 'end' : this.#hovered ? 'take' : this.#shown.tool === 'select' ? 'choose' : 'draw'
    this.#element.dataset.pointer = panning ? 'panning' : space ? 'pan' : choosing
  }

  #pressed(event: KeyboardEvent): void {
    const command = keyCommand(event)
    if (!command || !this.#shown.sheet) return
    event.preventDefault()
    this.#command(command, this.#shown.sheet)
  }

  #command(command: KeyCommand, photo: Extent): void {
    const { type } = command
    if (type === 'step') this.#step(command, photo)
    else if (type === 'pen') this.#penKey(photo)
    else if (type === 'escape') this.#escape()
    else if (type === 'remove') this.events.remove()
    else if (type === 'zoom') this.zoom(command.factor)
    else if (type === 'fit') this.fit()
    else this.actual()
  }

  #step(step: KeyCommand & { type: 'step' }, photo: Extent): void {
    const at = this.#aim ? stepped(this.#aim, step, photo) : this.#middle(photo)
    this.#aim = at
    this.#pen?.add(at, 0)
    this.#camera.show(at)
    this.#scene.layers.touch('pen')
    this.events.said({ pen: 'move', at })
  }

  #penKey(photo: Extent): void {
    const at = this.#aim ?? this.#middle(photo)
    this.#aim = at
    this.#scene.layers.touch('pen')
    const { tool } = this.#shown
    if (tool === 'select') this.#select(toScreen(this.#camera.view, at), REACH.mouse)
    else this.#turnPen(tool, photo, at)
  }

  #turnPen(kind: DrawnKind, photo: Extent, at: Point): void {
    if (this.#pen) this.#finish()
    else {
      this.#pen = new PenLine(kind, photo, null, kind === 'branch' ? this.#shown.brush : null)
      this.#pen.add(at, 0)
    }
    this.events.said({ pen: this.#pen ? 'down' : 'up', at })
  }

  #escape(): void {
    if (this.#pen) this.#putAway()
    else if (this.#shown.selection) this.events.selected(null)
  }

  get #status(): SketchStatus {
    const focused = document.activeElement === this.#element
    const { view } = this.#camera
    return { view, traced: this.#traced, hovered: this.#hovered, pen: this.#pen, aim: focused ? this.#aim : null }
  }

  /** The place of the photo in the middle of the window. */
  #middle({ width, height }: Extent): Point {
    const { clientWidth, clientHeight } = this.#element
    const [x, y] = toPhoto(this.#camera.view, [clientWidth / 2, clientHeight / 2])
    return [within(x, 0, width), within(y, 0, height)]
  }
}

function sameSize(one: Extent, other: Extent): boolean {
  return one.width === other.width && one.height === other.height
}
