import { beforeEach, expect, test } from 'vitest'
import type { Measured } from '../../../src/preview/capture/measured'
import type { Editing } from '../../../src/preview/edit/editLayer'
import { Store } from '../../../src/state'
import { NO_STROKES, withEdit } from '../../../src/strokes'
import { branchesOf, followMeasured, measuredOf } from '../../../src/ui/capture/followMeasured'
import { camera, captureAnswer, captureSheets, photoSheets } from '../../builders'
import { settle } from '../../service'

let store: Store
let shown: (Measured | null)[]
let edited: (Editing | null)[]
let photos: (string | null)[]
let pictures: [string, string][]

beforeEach(() => {
  store = new Store()
  shown = []
  edited = []
  photos = []
  const thumbnails = { of: async ({ name }: { name: string }) => `blob:${name}` }
  pictures = []
  followMeasured(
    { store, thumbnails },
    {
      showMeasured: measured => shown.push(measured),
      choosePhoto: photo => photos.push(photo),
      setEditing: editing => edited.push(editing),
      setPictures: urls => pictures.push(...urls),
    },
  )
})

test('a photo alone has nothing that many measured', () => {
  store.set({ sheets: photoSheets() })
  expect([measuredOf(store.state), shown, photos]).toEqual([null, [null], [null]])
})

test('cameras are shown once they are found, the tree once it is traced, and nothing twice', () => {
  store.set({ sheets: captureSheets() })
  expect(shown.at(-1)).toBeNull()
  store.set({ sheets: captureSheets(['a.jpg'], { cameras: [camera('a.jpg')] }) })
  expect(shown.at(-1)).toMatchObject({ tree: null, front: null })
  store.set({ traced: { of: NO_STROKES, answer: captureAnswer() } })
  expect(shown.at(-1)!.tree!.branches.points).toHaveLength(2)
  const count = shown.length
  store.set({ online: false })
  store.announce('Hello')
  expect(shown).toHaveLength(count)
})

test('the photos’ small pictures are shown once their cameras are found', async () => {
  store.set({ sheets: captureSheets(['a.jpg']) })
  await settle()
  expect(pictures).toEqual([])
  store.set({ sheets: captureSheets(['a.jpg'], { cameras: [camera('a.jpg')] }) })
  await settle()
  expect(pictures).toEqual([['a.jpg', 'blob:a.jpg']])
})

test('edits that the service has not answered are shown at once', () => {
  store.set({ sheets: captureSheets(), traced: { of: NO_STROKES, answer: captureAnswer() } })
  const next = withEdit(NO_STROKES, { do: 'move', at: [0, -2, 0], to: [1, -2, 0] })
  store.set({ history: { past: [NO_STROKES], present: next, future: [] } })
  expect(branchesOf(store.state)!.points[1]).toEqual([1, -2, 0])
  store.set({ history: { past: [], present: NO_STROKES, future: [next] } })
  expect(branchesOf(store.state)!.points[1]).toEqual([0, -2, 0])
})

test('branches are edited only while a tool for them is chosen', () => {
  store.set({ sheets: captureSheets(), traced: { of: NO_STROKES, answer: captureAnswer() } })
  expect(edited.at(-1)).toBeNull()
  store.set({ branchTool: 'add', selection: { kind: 'traced', joint: 1 } })
  expect(edited.at(-1)).toMatchObject({ tool: 'add', selected: 1 })
})
