import type { Client } from '../api/client'
import { advance, mapHistory } from '../history'
import { type Extent, fittedTo, isDrawn, openSheets, paper, replaceSheet, sheetOf, sheetOfSize } from '../sheets'
import type { PhotoSheet, Sheet, State, Store } from '../state'
import { NO_STROKES, onSheet, type SheetName, withSheet } from '../strokes'
import { faultOf } from './faultText'
import { convertPicture, upload } from './photos'
import type { SketchFile } from './sketches'

/** Opens, closes and activates sheets, and changes the pictures under their strokes. */
export class SheetActions {
  constructor(
    private readonly store: Store,
    private readonly client: Client,
    private readonly sizeOf: (picture: Blob) => Promise<Extent> = decodedSize,
  ) {}

  /** Open the side's sheet, as high as the front's. */
  openSide(): void {
    const { sheets } = this.store.state
    if (!sheets || sheets.side) return
    const opened = replaceSheet(sheets, 'side', paper(sheets.front.height))
    if (opened.side) this.store.set({ sheets: opened, active: 'side', tool: 'branch' })
  }

  /** Close the side's sheet and remove its strokes; undoing that opens the sheet again. */
  closeSide(): void {
    const { sheets } = this.store.state
    if (!sheets?.side) return
    const { history } = { ...this.store.state, ...withSheetUnder(this.store.state, 'side', paper(sheets.front.height)) }
    const without = isDrawn(history.present, 'side') ? advance(history, onSheet(history.present, 'front')) : history
    this.store.set({ sheets: { ...sheets, side: null }, active: 'front', selection: null, history: without })
  }

  /** Make a sheet the active one. */
  activate(sheet: SheetName): void {
    if (openSheets(this.store.state).includes(sheet)) this.store.set({ active: sheet })
  }

  /** Choose the brush for branches on paper: its width as a share of the paper's height; null for a pencil. */
  chooseBrush(brush: number | null): void {
    this.store.set({ brush, tool: 'branch', selection: null })
  }

  /** Put a picture under a sheet's strokes; the front's is sent to the service, since it gives the tree its colours. */
  async addPicture(name: SheetName, file: Blob): Promise<void> {
    const before = sheetOf(this.store.state, name)
    try {
      const sheet = name === 'front' ? await this.#upload(file) : await this.#local(file)
      if (before && sheetOf(this.store.state, name) === before) {
        this.store.set(withSheetUnder(this.store.state, name, sheet))
        if (sheet.corrections) this.store.set({ corrections: { of: this.store.strokes, text: sheet.corrections } })
      }
      this.store.fault('photo', null)
    } catch (error) {
      this.store.fault('photo', faultOf(error))
    }
  }

  /** Remove the picture from under a sheet's strokes. */
  removePicture(name: SheetName): void {
    this.#change(name, sheetOfSize)
  }

  /** Show or hide the picture under a sheet's strokes. */
  showPicture(name: SheetName, shown: boolean): void {
    this.#change(name, ({ hidden: _, ...sheet }) => (shown ? sheet : { ...sheet, hidden: true }))
  }

  #change(name: SheetName, change: (sheet: Sheet) => Sheet): void {
    const { sheets } = this.store.state
    if (sheets?.[name]) this.store.set({ sheets: replaceSheet(sheets, name, change(sheets[name])) })
  }

  #upload(file: Blob): Promise<PhotoSheet> {
    return upload(file, this.client, this.store.state.limits)
  }

  /** Return a sheet with a picture that stays in the browser; one that it cannot show is converted by the service. */
  async #local(chosen: Blob): Promise<Sheet> {
    const { limits } = this.store.state
    const decoded = await this.sizeOf(chosen).catch(() => null)
    const file = decoded ? chosen : await convertPicture(chosen, this.client, limits)
    const size = decoded ?? (await this.sizeOf(file))
    return { ...sheetOfSize(size), file, url: URL.createObjectURL(file) }
  }
}

/** Return the state with a sketch in place of a sheet's strokes; paper without a picture takes the sketch's size. */
export function replaceDrawing(state: State, name: SheetName, { strokes, size }: SketchFile): Partial<State> {
  const before = sheetOf(state, name)!
  const sheet = before.url ? before : sheetOfSize(size)
  const { history, sheets } = { ...state, ...withSheetUnder(state, name, sheet) }
  const drawn = withSheet(history.present, name, fittedTo(strokes, size, sheet))
  return { sheets, history: advance(history, drawn), selection: null, active: name, tool: 'branch' }
}

/** Return the state with another sheet under a sheet's strokes; these, and all in the history, are fitted to it. */
function withSheetUnder(
  { history, sheets }: State,
  name: SheetName,
  sheet: Sheet,
): Pick<State, 'sheets'> & Partial<State> {
  const before = sheets![name]!
  const open = replaceSheet(sheets!, name, sheet)
  if (before.width === sheet.width && before.height === sheet.height) return { sheets: open }
  const fitted = mapHistory(history, strokes =>
    isDrawn(strokes, name)
      ? withSheet(strokes, name, { ...NO_STROKES, ...fittedTo(onSheet(strokes, name), before, sheet) })
      : strokes,
  )
  return { sheets: open, history: fitted, selection: null }
}

async function decodedSize(picture: Blob): Promise<Extent> {
  const bitmap = await createImageBitmap(picture)
  const { width, height } = bitmap
  bitmap.close()
  return { width, height }
}
