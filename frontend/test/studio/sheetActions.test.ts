import { afterEach, expect, test, vi } from 'vitest'
import { Client } from '../../src/api/client'
import { paper } from '../../src/sheets'
import { Store } from '../../src/state'
import { Desk } from '../../src/studio/sheetActions'
import { Sketchbook } from '../../src/studio/strokeActions'
import { LIMB, photo, TRUNK } from '../builders'
import { problem, service } from '../service'

const PICTURE = new Blob(['a photo'], { type: 'image/jpeg' })
const WIDE = { width: 1800, height: 1200 }

afterEach(() => vi.unstubAllGlobals())

function begin() {
  const store = new Store()
  const desk = new Desk(store, new Client(), async () => WIDE)
  store.set({ source: 'sketch', photo: paper(), side: paper() })
  return { store, desk, sketchbook: new Sketchbook(store) }
}

test('the side’s sheet opens as high as the photo beside it, and a branch is what is drawn next', () => {
  const { store, desk } = begin()
  store.set({ source: 'photo', photo: photo({ height: 600 }), side: null })
  desk.openSide()
  expect(store.state).toMatchObject({ side: { width: 450, height: 600 }, sheet: 'side', tool: 'branch' })
})

test('a sheet that is put away takes its strokes along, and an undo brings both back', () => {
  const { store, desk, sketchbook } = begin()
  sketchbook.draw('branch', TRUNK)
  sketchbook.draw('branch', LIMB, 'side')
  desk.closeSide()
  expect([store.state.side, store.strokes.side]).toEqual([null, undefined])
  sketchbook.undo()
  expect(store.state.side).toMatchObject({ width: 900, height: 1200 })
  expect(store.strokes.side?.branches).toEqual([{ points: LIMB }])
})

test('a picture under the side stays in the browser; strokes keep their place on it, undone ones too', async () => {
  const calls = service(() => problem(500, 'oops', 'no'))
  const { store, desk, sketchbook } = begin()
  sketchbook.draw('branch', TRUNK, 'side')
  await desk.lay('side', PICTURE)
  expect(calls).toEqual([])
  expect(store.state.side).toMatchObject({ ...WIDE, file: PICTURE, id: null })
  expect(store.strokes.side?.branches[0]?.points).toEqual(TRUNK.map(([x, y]) => [x + 450, y]))
  sketchbook.undo()
  sketchbook.redo()
  expect(store.strokes.side?.branches[0]?.points[0]?.[0]).toBe(TRUNK[0]![0] + 450)
})

test('a picture under the front is sent, since it lends the tree its colours', async () => {
  vi.stubGlobal('createImageBitmap', async () => ({ ...WIDE, close() {} }))
  service(() => Response.json({ id: 'pho_9', ...WIDE, image: '/v1/photos/pho_9/image' }, { status: 201 }))
  const { store, desk } = begin()
  await desk.lay('front', PICTURE)
  expect(store.state.photo).toMatchObject({ id: 'pho_9', ...WIDE })
  desk.show('front', false)
  expect(store.state.photo?.hidden).toBe(true)
  desk.lift('front')
  expect(store.state.photo).toEqual({ id: null, ...WIDE, file: null, url: null })
})

test('what is no picture leaves the sheet as it was, and is said as the service says it', async () => {
  service(() => problem(422, 'format_not_allowed', 'photo: this is a PDF document; export its picture'))
  const { store } = begin()
  const desk = new Desk(store, new Client(), () => Promise.reject(new Error('no picture')))
  await desk.lay('side', PICTURE)
  expect(store.state.side).toEqual(paper())
  expect(store.state.faults.photo?.text).toBe('This is a PDF document; export its picture.')
})

test('a picture that the browser cannot show lies under the side as the service shows it, which keeps nothing', async () => {
  const png = new Blob(['dots'], { type: 'image/png' })
  const calls = service(({ method, path }) => {
    if (method === 'DELETE') return new Response(null, { status: 204 })
    if (path.endsWith('/image')) return new Response(png)
    return Response.json({ id: 'pho_9', ...WIDE, image: '/v1/photos/pho_9/image' }, { status: 201 })
  })
  const { store } = begin()
  const desk = new Desk(store, new Client(), async file => (file.type === 'image/png' ? WIDE : Promise.reject(file)))
  await desk.lay('side', new File(['a photo'], 'oak.heic'))
  expect(store.state.side).toMatchObject({ ...WIDE, id: null })
  expect(await store.state.side?.file?.text()).toBe('dots')
  expect(calls.map(({ method, path }) => `${method} ${path}`).at(-1)).toBe('DELETE /v1/photos/pho_9')
})

test('what was mended in a picture under the front is said until something is drawn', async () => {
  const warnings = [{ code: 'photo_cut_short', stroke: 'photo', detail: 'the file is cut short' }]
  service(() => Response.json({ id: 'pho_9', ...WIDE, image: '/image', warnings }, { status: 201 }))
  const { store, desk } = begin()
  await desk.lay('front', new Blob(['a photo'], { type: 'image/heic' }))
  expect(store.state.remark).toEqual({ of: store.strokes, text: 'The file is cut short.' })
})

test('a brush is taken up with the branch, and its width goes with each stroke on paper', () => {
  const { store, desk, sketchbook } = begin()
  sketchbook.hold('crown')
  desk.takeBrush(0.02)
  expect(store.state.tool).toBe('branch')
  sketchbook.draw('branch', TRUNK)
  sketchbook.draw('crown', LIMB)
  expect(store.strokes.branches[0]?.width).toBe(24)
  store.set({ source: 'photo' })
  sketchbook.draw('branch', TRUNK)
  expect(store.strokes.branches[1]).not.toHaveProperty('width')
})
