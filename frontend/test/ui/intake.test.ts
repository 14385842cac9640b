// @vitest-environment jsdom
import { beforeAll, beforeEach, expect, test, vi } from 'vitest'
import { paper } from '../../src/sheets'
import { Store } from '../../src/state'
import type { Studio } from '../../src/studio/studio'
import { text } from '../../src/text'
import { takeFiles } from '../../src/ui/intake'

const store = new Store()
const [openFile, openSketch, openOn, lay] = [vi.fn(), vi.fn(), vi.fn(), vi.fn()]
const studio = { store, opener: { openFile, openSketch, openOn }, desk: { lay } } as unknown as Studio
const png = new File(['dots'], 'oak.png', { type: 'image/png' })
const jpeg = new File(['dots'], 'oak.jpg', { type: 'image/jpeg' })
const side = document.createElement('div')

beforeAll(() => {
  side.dataset.of = 'side'
  document.body.append(side)
  side.getBoundingClientRect = () => new DOMRect(500, 100, 400, 600)
  vi.stubGlobal('innerHeight', 800)
  takeFiles(studio)
})
beforeEach(() => {
  vi.clearAllMocks()
  store.set({ source: 'photo', photo: null, side: null })
})

/** Drag a file over a part of the page, and let go of it there. */
function drop(file: File, target: Element, clientY: number): string[] {
  const items = [{ kind: 'file', type: file.type }]
  for (const name of ['dragover', 'drop']) {
    const event = new MouseEvent(name, { bubbles: true, cancelable: true, clientY })
    Object.defineProperty(event, 'dataTransfer', { value: { types: ['Files'], items, files: [file] } })
    target.dispatchEvent(event)
  }
  return [...document.querySelectorAll('.drop-field.chosen strong')].map(said => said.textContent)
}

test('a PNG that is dropped on the page is a photo above and a drawing below, as it says', () => {
  expect(drop(png, document.body, 100)).toEqual([text.sheets.drop.photo[0]])
  expect([openFile.mock.calls, openSketch.mock.calls]).toEqual([[[png]], []])
  expect(drop(png, document.body, 700)).toEqual([text.sheets.drop.drawing[0]])
  expect([openFile.mock.calls.length, openSketch.mock.calls]).toEqual([1, [[png]]])
})

test('a PNG that is dropped on a sheet is laid under it above, and opened on it below', () => {
  store.set({ source: 'sketch', photo: paper(), side: paper() })
  expect(drop(png, side, 390)).toEqual([text.sheets.drop.lay[0]])
  expect(lay.mock.calls).toEqual([['side', png]])
  drop(png, side, 410)
  expect(openOn.mock.calls).toEqual([['side', png]])
  expect([openFile.mock.calls, openSketch.mock.calls]).toEqual([[], []])
})

test('a picture that can be no drawing is a photo wherever it is dropped', () => {
  drop(jpeg, document.body, 790)
  store.set({ source: 'sketch', photo: paper(), side: paper() })
  drop(jpeg, side, 690)
  expect([openFile.mock.calls, lay.mock.calls]).toEqual([[[jpeg]], [['side', jpeg]]])
})

test('a photo that the browser has no type for is laid under the sheet that it is dropped on', () => {
  const heic = new File(['dots'], 'oak.HEIC')
  drop(heic, document.body, 10)
  store.set({ source: 'sketch', photo: paper(), side: paper() })
  drop(heic, side, 390)
  expect([openFile.mock.calls, lay.mock.calls]).toEqual([[[heic]], [['side', heic]]])
})

test('strokes are a drawing wherever they are dropped, and what is neither is said', () => {
  const strokes = new File(['{}'], 'oak.json', { type: 'application/json' })
  drop(strokes, document.body, 10)
  expect(openSketch.mock.calls).toEqual([[strokes]])
  drop(new File(['x'], 'notes.txt', { type: 'text/plain' }), document.body, 10)
  expect(store.state.faults.photo?.text).toBe(text.welcome.notThis)
})
