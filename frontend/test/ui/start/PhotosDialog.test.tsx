// @vitest-environment jsdom
import { act } from 'preact/test-utils'
import { beforeEach, expect, test, vi } from 'vitest'
import { Store } from '../../../src/state'
import type { Studio } from '../../../src/studio/studio'
import { text } from '../../../src/text'
import { openFiles } from '../../../src/ui/parts/files'
import { PhotosDialog } from '../../../src/ui/start/PhotosDialog'
import { captureSheets } from '../../builders'
import { mount } from '../mount'

const { offer: words } = text.capture
const jpeg = (name: string) => new File(['dots'], name, { type: 'image/jpeg' })
const jpegs = (count: number) => Array.from({ length: count }, (_, at) => jpeg(`${at}.jpg`))

let store: Store
let studio: Studio
const [openFile, openPhotos, add] = [vi.fn(), vi.fn(), vi.fn()]

beforeEach(() => {
  vi.clearAllMocks()
  HTMLDialogElement.prototype.showModal = () => {}
  HTMLDialogElement.prototype.close = () => {}
  URL.createObjectURL = () => 'blob:photo'
  URL.revokeObjectURL = () => {}
  store = new Store()
  store.set({ limits: { capture_photos_min: 5, capture_photos_max: 60 } as never })
  studio = { store, opener: { openFile, openPhotos }, captures: { add } } as unknown as Studio
})

/** Choose files and see what the dialog says. */
function choose(files: readonly File[], folder = ''): HTMLElement {
  openFiles(studio, files, folder)
  return mount(studio, <PhotosDialog />)
}

function click(host: HTMLElement, label: string): void {
  const button = [...host.querySelectorAll('button')].find(({ textContent }) => textContent?.includes(label))!
  act(() => button.click())
}

test('one photo is opened at once, and so is a project', () => {
  const [one, project] = [jpeg('oak.jpg'), new File([], 'oak.treestroke')]
  openFiles(studio, [one, new File([], 'notes.txt')])
  openFiles(studio, [project])
  expect(openFile.mock.calls).toEqual([[one], [project]])
  expect(store.state.dialog).toBeNull()
})

test('files without a photo are refused', () => {
  openFiles(studio, [new File([], 'notes.txt')])
  expect(store.state.faults.photo?.text).toBe(text.welcome.unknownFile)
})

test('several photos are sent only after it was said what becomes of them', () => {
  const photos = jpegs(18)
  const host = choose(photos, 'The oak')
  expect(host.textContent).toContain(words.title(18))
  expect(openPhotos).not.toHaveBeenCalled()
  click(host, words.start(18))
  expect(openPhotos.mock.calls).toEqual([[photos, 'The oak']])
  expect(store.state.dialog).toBeNull()
})

test('one of them can be opened alone', () => {
  const photos = jpegs(6)
  click(choose(photos), words.openOne('3.jpg'))
  expect(openFile.mock.calls).toEqual([[photos[3]]])
})

test('too few or too many are told, and cannot be started with', () => {
  const few = choose(jpegs(3)).textContent
  expect(few).toContain(words.tooFew(3, 5))
  expect(few).not.toContain(words.start(3))
  expect(choose(jpegs(61)).textContent).toContain(words.tooMany(61, 60))
})

test('other files are named, those of the system are not', () => {
  const others = ['notes.txt', 'strokes.json', '.DS_Store', 'Thumbs.db'].map(name => new File([], name))
  choose([...jpegs(5), ...others])
  expect(store.state.offer?.others).toEqual(['notes.txt', 'strokes.json'])
})

test('while a tree of many photos is open, they can be added to it', () => {
  store.set({ sheets: captureSheets() })
  const photos = jpegs(5)
  click(choose(photos), words.add(5))
  expect(add.mock.calls).toEqual([[photos]])
})
