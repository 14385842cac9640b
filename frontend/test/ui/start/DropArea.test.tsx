// @vitest-environment jsdom
import { render } from 'preact'
import { act } from 'preact/test-utils'
import { beforeAll, beforeEach, expect, test, vi } from 'vitest'
import { paper } from '../../../src/sheets'
import { Store } from '../../../src/state'
import type { Studio } from '../../../src/studio/studio'
import { text } from '../../../src/text'
import { StudioProvider } from '../../../src/ui/parts/useStore'
import { DropArea } from '../../../src/ui/start/DropArea'
import { sketchSheets } from '../../builders'
import { settle } from '../../service'

const store = new Store()
const [openFile, openSketch, openOn, addPicture] = [vi.fn(), vi.fn(), vi.fn(), vi.fn()]
const studio = { store, opener: { openFile, openSketch, openOn }, sheets: { addPicture } } as unknown as Studio
const png = new File(['dots'], 'oak.png', { type: 'image/png' })
const jpeg = new File(['dots'], 'oak.jpg', { type: 'image/jpeg' })
const side = document.createElement('div')

beforeAll(() => {
  const page = document.createElement('div')
  side.dataset.of = 'side'
  document.body.append(page, side)
  side.getBoundingClientRect = () => new DOMRect(500, 100, 400, 600)
  vi.stubGlobal('innerHeight', 800)
  act(() =>
    render(
      <StudioProvider value={studio}>
        <DropArea />
      </StudioProvider>,
      page,
    ),
  )
})
beforeEach(() => {
  vi.clearAllMocks()
  store.set({ sheets: null })
})

/** Drag a file over a part of the page, and drop it there; gives what was chosen meanwhile. */
function drop(file: File, target: Element, clientY: number, ...more: File[]): string[] {
  const files = [file, ...more]
  const items = files.map(({ type }) => ({ kind: 'file', type }))
  const send = (name: string) => {
    const event = new MouseEvent(name, { bubbles: true, cancelable: true, clientY })
    Object.defineProperty(event, 'dataTransfer', { value: { types: ['Files'], items, files } })
    act(() => void target.dispatchEvent(event))
  }
  send('dragover')
  const said = [...document.querySelectorAll('.drop-field.chosen strong')].map(({ textContent }) => textContent)
  send('drop')
  expect(document.querySelector('.drop-area')).toBeNull()
  return said
}

test('a PNG that is dropped on the page is a photo above and a drawing below, as it says', () => {
  expect(drop(png, document.body, 100)).toEqual([text.sheets.drop.photo[0]])
  expect([openFile.mock.calls, openSketch.mock.calls]).toEqual([[[png]], []])
  expect(drop(png, document.body, 700)).toEqual([text.sheets.drop.drawing[0]])
  expect([openFile.mock.calls.length, openSketch.mock.calls]).toEqual([1, [[png]]])
})

test('a PNG that is dropped on a sheet is laid under it above, and opened on it below', () => {
  store.set({ sheets: sketchSheets(paper(), paper()) })
  expect(drop(png, side, 390)).toEqual([text.sheets.drop.picture[0]])
  expect(addPicture.mock.calls).toEqual([['side', png]])
  drop(png, side, 410)
  expect(openOn.mock.calls).toEqual([['side', png]])
  expect([openFile.mock.calls, openSketch.mock.calls]).toEqual([[], []])
})

test('a picture that can be no drawing is a photo wherever it is dropped', async () => {
  drop(jpeg, document.body, 790)
  await settle()
  store.set({ sheets: sketchSheets(paper(), paper()) })
  drop(jpeg, side, 690)
  expect([openFile.mock.calls, addPicture.mock.calls]).toEqual([[[jpeg]], [['side', jpeg]]])
})

test('a photo that the browser has no type for is laid under the sheet that it is dropped on', async () => {
  const heic = new File(['dots'], 'oak.HEIC')
  drop(heic, document.body, 10)
  await settle()
  store.set({ sheets: sketchSheets(paper(), paper()) })
  drop(heic, side, 390)
  expect([openFile.mock.calls, addPicture.mock.calls]).toEqual([[[heic]], [['side', heic]]])
})

test('strokes are a drawing wherever they are dropped, and what is neither is said', async () => {
  const strokes = new File(['{}'], 'oak.json', { type: 'application/json' })
  drop(strokes, document.body, 10)
  expect(openSketch.mock.calls).toEqual([[strokes]])
  drop(new File(['x'], 'notes.txt', { type: 'text/plain' }), document.body, 10)
  await settle()
  expect(store.state.faults.photo?.text).toBe(text.welcome.unknownFile)
})

test('several photos are those of one tree, even over a sheet of paper', async () => {
  store.set({ sheets: sketchSheets(paper(), paper()) })
  expect(drop(jpeg, side, 300, png)).toEqual([text.capture.offer.drop])
  await settle()
  expect(store.state).toMatchObject({ dialog: 'photos', offer: { photos: [jpeg, png] } })
})

test('it is said what becomes of a video that is dropped, and of a GIF, before anything is sent', async () => {
  for (const video of [
    new File(['frames'], 'ash.mp4', { type: 'video/mp4' }),
    new File(['frames'], 'ash.gif', { type: 'image/gif' }),
  ]) {
    expect(drop(video, document.body, 100)).toEqual([text.clip.drop])
    await settle()
    expect(store.state).toMatchObject({ dialog: 'clip', clipOffer: video })
    store.set({ dialog: null, clipOffer: null })
  }
  expect(openFile).not.toHaveBeenCalled()
})
