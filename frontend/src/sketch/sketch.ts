import type { Photo, Selection, State, Store, TraceAnswer } from '../state'
import type { Line, Point } from '../strokes'
import { Camera } from './camera'
import { AT_REST, type DrawnKind, type GestureEvent, gestured, type Intent, type PointerKind } from './gesture'
import { type KeyCommand, keyCommand, stepped } from './keys'
import { PenLine } from './penLine'
import { otherEnd, pick } from './pick'
import { listenToPointers, listenToSpace } from './pointing'
import { Scene, type Sight } from './scene'
import './sketch.css'
import { toPhoto, toScreen, type View, within } from './viewport'

export interface SketchLabels {
  /** The canvas's name. */
  readonly canvas: string
  /** How to draw by keyboard. */
  readonly keys: string
}

export interface SketchEvents {
  /** One stroke is finished, in photo px. */
  drew(kind: DrawnKind, points: Line): void
  selected(selection: Selection | null): void
  /** What is selected is to go. */
  remove(): void
  /** Where the photo lies in the window now. */
  looked(view: View): void
  /** What the keyboard's pen does, in photo px. */
  said(what: { pen: 'down' | 'up' | 'move'; at: Point }): void
}

/** Points of a stroke are as far apart at least, CSS px. */
const APART = 0.7
/** A click takes what lies as near, CSS px. */
const REACH: Record<PointerKind, number> = { mouse: 10, pen: 10, touch: 20 }
/** A press as near to an end of the measured line moves it, CSS px. */
const END_REACH = 14

/** The canvas over the photo that a person draws on. */
export class Sketch {
  readonly #element = document.createElement('div')
  readonly #camera = new Camera(view => this.#looked(view))
  readonly #scene = new Scene(
    this.#element,
    () => this.#sight,
    () => this.#state,
  )
  readonly #resizing = new ResizeObserver(() => this.#resize())
  #state: State
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
    labels: SketchLabels,
  ) {
    this.#state = store.state
    this.#label(labels)
    host.append(this.#element)
    this.#listen()
    this.#resizing.observe(this.#element)
    this.#open(this.#state.photo)
    this.#resize()
    // A listener before this one may have gone on to a newer state already.
    store.watch(
      state => state,
      () => this.#changed(store.state),
    )
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

  #label({ canvas, keys }: SketchLabels): void {
    this.#element.className = 'sketch-surface'
    this.#element.tabIndex = 0
    this.#element.role = 'application'
    this.#element.ariaLabel = canvas
    this.#element.setAttribute('aria-description', keys)
  }

  #listen(): void {
    const gesture = (event: GestureEvent) => this.#gestured(event)
    const tool = (at: Point) => (this.#state.tool === 'select' && this.#otherEnd(at) ? 'scale' : this.#state.tool)
    const wheel = (intent: Intent) => this.#do(intent)
    listenToPointers(this.#element, { tool, gesture, wheel, hover: at => this.#hover(at) })
    listenToSpace(this.#element, held => this.#gestured({ type: 'space', held }))
    this.#element.addEventListener('keydown', event => this.#pressed(event))
    this.#element.addEventListener('focus', () => this.#focused())
    this.#element.addEventListener('blur', () => this.#scene.layers.touch('pen'))
  }

  /** Who comes by keyboard sees where the pen is. */
  #focused(): void {
    const { photo } = this.#state
    if (photo && this.#element.matches(':focus-visible')) this.#aim ??= this.#middle(photo)
    this.#scene.layers.touch('pen')
  }

  #resize(): void {
    const { clientWidth: width, clientHeight: height } = this.#element
    this.#camera.resize({ width, height })
    this.#scene.layers.resize({ width, height }, window.devicePixelRatio)
  }

  #looked({ scale, x, y }: View): void {
    this.#element.dataset.view = [scale, x, y].join(',')
    this.#scene.layers.touchAll()
    this.events.looked({ scale, x, y })
  }

  #changed(now: State): void {
    const before = this.#state
    this.#state = now
    if (now.photo?.id !== before.photo?.id) {
      this.#foreign = now.traced === before.traced ? (now.traced?.answer ?? null) : null
      this.#open(now.photo)
    } else if (now.photo !== before.photo) this.#scene.picture.show(now.photo)
    if (now.tool !== before.tool) this.#putAway()
    if (now.history !== before.history || now.traced !== before.traced) this.#hovered = null
    this.#element.classList.toggle('sketch-stale', now.traced !== null && now.traced.of !== now.history.present)
    this.#scene.layers.touch('strokes')
    if (now.traced !== before.traced || now.history !== before.history) this.#scene.layers.touch('traced')
    this.#pointAt()
  }

  #open(photo: Photo | null): void {
    this.#putAway()
    this.#aim = null
    this.#scene.picture.show(photo)
    if (photo) this.#camera.open(photo)
    this.#scene.layers.touchAll()
  }

  #putAway(): void {
    this.#pen = null
    this.#gesture = gestured(this.#gesture, { type: 'escape' }).state
    this.#scene.layers.touch('pen')
  }

  get #traced(): TraceAnswer | null {
    const { traced, history } = this.#state
    return history.present.crown && traced && traced.answer !== this.#foreign ? traced.answer : null
  }

  #gestured(event: GestureEvent): void {
    if (!this.#state.photo) return
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
    this.#pen = new PenLine(kind, this.#state.photo!, kind === 'scale' ? this.#otherEnd(at) : null)
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
    this.events.selected(this.#pick(at, reach))
  }

  #pick(at: Point, reach: number): Selection | null {
    const { view } = this.#camera
    const skeleton = this.#traced?.skeleton ?? null
    return pick(this.#state.history.present, skeleton, toPhoto(view, at), reach / view.scale)
  }

  /** The end that stays where the one at a place in the window is moved. */
  #otherEnd(at: Point): Point | null {
    const { view } = this.#camera
    return otherEnd(this.#state.history.present, toPhoto(view, at), END_REACH / view.scale)
  }

  #hover(at: Point | null): void {
    const { photo, tool } = this.#state
    const free = photo && this.#gesture.mode.name === 'idle' ? at : null
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
    const choosing = this.#overEnd ? 'end' : this.#hovered ? 'take' : this.#state.tool === 'select' ? 'choose' : 'draw'
    this.#element.dataset.pointer = panning ? 'panning' : space ? 'pan' : choosing
  }

  #pressed(event: KeyboardEvent): void {
    const command = keyCommand(event)
    if (!command || !this.#state.photo) return
    event.preventDefault()
    this.#command(command, this.#state.photo)
  }

  #command(command: KeyCommand, photo: Photo): void {
    const { type } = command
    if (type === 'step') this.#step(command, photo)
    else if (type === 'pen') this.#penKey(photo)
    else if (type === 'escape') this.#escape()
    else if (type === 'remove') this.events.remove()
    else if (type === 'zoom') this.zoom(command.factor)
    else if (type === 'fit') this.fit()
    else this.actual()
  }

  #step(step: KeyCommand & { type: 'step' }, photo: Photo): void {
    const at = this.#aim ? stepped(this.#aim, step, photo) : this.#middle(photo)
    this.#aim = at
    this.#pen?.add(at, 0)
    this.#camera.show(at)
    this.#scene.layers.touch('pen')
    this.events.said({ pen: 'move', at })
  }

  #penKey(photo: Photo): void {
    const at = this.#aim ?? this.#middle(photo)
    this.#aim = at
    this.#scene.layers.touch('pen')
    if (this.#state.tool === 'select') this.#select(toScreen(this.#camera.view, at), REACH.mouse)
    else this.#turnPen(this.#state.tool, photo, at)
  }

  #turnPen(kind: DrawnKind, photo: Photo, at: Point): void {
    if (this.#pen) this.#finish()
    else {
      this.#pen = new PenLine(kind, photo)
      this.#pen.add(at, 0)
    }
    this.events.said({ pen: this.#pen ? 'down' : 'up', at })
  }

  #escape(): void {
    if (this.#pen) this.#putAway()
    else if (this.#state.selection) this.events.selected(null)
  }

  get #sight(): Sight {
    const focused = document.activeElement === this.#element
    const { view } = this.#camera
    return { view, traced: this.#traced, hovered: this.#hovered, pen: this.#pen, aim: focused ? this.#aim : null }
  }

  /** The place of the photo in the middle of the window. */
  #middle({ width, height }: Photo): Point {
    const { clientWidth, clientHeight } = this.#element
    const [x, y] = toPhoto(this.#camera.view, [clientWidth / 2, clientHeight / 2])
    return [within(x, 0, width), within(y, 0, height)]
  }
}
