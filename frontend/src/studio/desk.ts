import type { Client } from '../api/client'
import { advance, throughout } from '../history'
import { fittedTo, groundOf, isDrawn, openSheets, paper, sheetOfSize } from '../sheets'
import type { Ground, State, Store } from '../state'
import { NO_STROKES, onSheet, type SheetName, withSheet } from '../strokes'
import { drawable, uploaded } from './photos'
import { faultOf } from './sentences'
import type { SketchFile } from './sketches'

/** Lays sheets out, and pictures under what is drawn on them. */
export class Desk {
  constructor(
    private readonly store: Store,
    private readonly client: Client,
    private readonly sizeOf: (picture: Blob) => Promise<Pick<Ground, 'width' | 'height'>> = decodedSize,
  ) {}

  /** Open the sheet of the tree's left side, as high as the front's. */
  openSide(): void {
    const { photo, side } = this.store.state
    if (photo && !side) this.store.set({ side: paper(photo.height), sheet: 'side', tool: 'branch' })
  }

  /** Put the side's sheet away with what is on it; an undo brings the strokes back, and it with them. */
  closeSide(): void {
    const { photo, side } = this.store.state
    if (!photo || !side) return
    const { history } = { ...this.store.state, ...relaid(this.store.state, 'side', paper(photo.height)) }
    const rest = isDrawn(history.present, 'side') ? advance(history, onSheet(history.present, 'front')) : history
    this.store.set({ side: null, sheet: 'front', selection: null, history: rest })
  }

  /** Go on with a sheet. */
  turnTo(sheet: SheetName): void {
    if (openSheets(this.store.state).includes(sheet)) this.store.set({ sheet })
  }

  /** Draw branches on paper so wide, as a share of its height; null for a pencil. */
  takeBrush(brush: number | null): void {
    this.store.set({ brush, tool: 'branch', selection: null })
  }

  /** Lay a picture under what is drawn on a sheet; the front's lends the tree its colours, so the service gets it. */
  async lay(sheet: SheetName, file: Blob): Promise<void> {
    const before = groundOf(this.store.state, sheet)
    try {
      const ground = sheet === 'front' ? await this.#upload(file) : await this.#guide(file)
      if (before && groundOf(this.store.state, sheet) === before) {
        this.store.set(relaid(this.store.state, sheet, ground))
        if (ground.mended) this.store.set({ remark: { of: this.store.strokes, text: ground.mended } })
      }
      this.store.fault('photo', null)
    } catch (error) {
      this.store.fault('photo', faultOf(error))
    }
  }

  /** Take the picture away from under a sheet's strokes. */
  lift(sheet: SheetName): void {
    this.#change(sheet, sheetOfSize)
  }

  /** Show the picture under a sheet's strokes, or leave it out of sight. */
  show(sheet: SheetName, shown: boolean): void {
    this.#change(sheet, ({ hidden: _, ...ground }) => (shown ? ground : { ...ground, hidden: true }))
  }

  #change(sheet: SheetName, change: (ground: Ground) => Ground): void {
    const ground = groundOf(this.store.state, sheet)
    if (ground) this.store.set({ [sheet === 'front' ? 'photo' : 'side']: change(ground) })
  }

  #upload(file: Blob): Promise<Ground> {
    return uploaded(file, this.client, this.store.state.limits)
  }

  /** Keep a picture in the browser; one that it cannot show (HEIC, in most) the service turns into one that it can. */
  async #guide(chosen: Blob): Promise<Ground> {
    const { limits } = this.store.state
    const known = await this.sizeOf(chosen).catch(() => null)
    const file = known ? chosen : await drawable(chosen, this.client, limits)
    const size = known ?? (await this.sizeOf(file))
    return { ...sheetOfSize(size), file, url: URL.createObjectURL(file) }
  }
}

/** Put a sketch in the place of a sheet's strokes, which an undo brings back; paper without a picture becomes as large. */
export function redrawn(state: State, sheet: SheetName, { strokes, size }: SketchFile): Partial<State> {
  const before = groundOf(state, sheet)!
  const ground = before.url ? before : sheetOfSize(size)
  const { history, ...laid } = { ...state, ...relaid(state, sheet, ground) }
  const drawn = withSheet(history.present, sheet, fittedTo(strokes, size, ground))
  return {
    photo: laid.photo,
    side: laid.side,
    history: advance(history, drawn),
    selection: null,
    sheet,
    tool: 'branch',
  }
}

/** Put another ground under a sheet's strokes, which keep their place on it in all that can be undone, too. */
function relaid({ history, ...state }: State, sheet: SheetName, ground: Ground): Partial<State> {
  const before = groundOf(state, sheet)!
  const same = before.width === ground.width && before.height === ground.height
  const moved = throughout(history, strokes =>
    isDrawn(strokes, sheet)
      ? withSheet(strokes, sheet, { ...NO_STROKES, ...fittedTo(onSheet(strokes, sheet), before, ground) })
      : strokes,
  )
  return {
    [sheet === 'front' ? 'photo' : 'side']: ground,
    ...(!same && { history: moved, selection: null }),
  }
}

async function decodedSize(picture: Blob): Promise<Pick<Ground, 'width' | 'height'>> {
  const { width, height, close } = await bitmapOf(picture)
  close()
  return { width, height }
}

async function bitmapOf(picture: Blob) {
  const bitmap = await createImageBitmap(picture)
  return { width: bitmap.width, height: bitmap.height, close: () => bitmap.close() }
}
