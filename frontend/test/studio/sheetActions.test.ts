import { afterEach, expect, test, vi } from 'vitest'
import { Client } from '../../src/api/client'
import { paper } from '../../src/sheets'
import { Store } from '../../src/state'
import { SheetActions } from '../../src/studio/sheetActions'
import { StrokeActions } from '../../src/studio/strokeActions'
import { LIMB, photo, photoSheets, sketchSheets, TRUNK } from '../builders'
import { problem, service } from '../service'

const PICTURE = new Blob(['a photo'], { type: 'image/jpeg' })
const WIDE = { width: 1800, height: 1200 }

afterEach(() => vi.unstubAllGlobals())

function begin() {
  const store = new Store()
  const actions = new SheetActions(store, new Client(), async () => WIDE)
  store.set({ sheets: sketchSheets(paper(), paper()) })
  return { store, actions, strokes: new StrokeActions(store) }
}

test('the side’s sheet opens as high as the photo beside it, with the branch tool', () => {
  const { store, actions } = begin()
  store.set({ sheets: photoSheets(photo({ height: 600 })) })
  actions.openSide()
  expect(store.state).toMatchObject({ sheets: { side: { width: 450, height: 600 } }, active: 'side', tool: 'branch' })
})

test('a sheet that is closed loses its strokes, and an undo brings both back', () => {
  const { store, actions, strokes } = begin()
  strokes.draw('branch', TRUNK)
  strokes.draw('branch', LIMB, 'side')
  actions.closeSide()
  expect([store.state.sheets?.side, store.strokes.side]).toEqual([null, undefined])
  strokes.undo()
  expect(store.state.sheets?.side).toMatchObject({ width: 900, height: 1200 })
  expect(store.strokes.side?.branches).toEqual([{ points: LIMB }])
})

test('a picture under the side stays in the browser; strokes keep their place on it, undone ones too', async () => {
  const calls = service(() => problem(500, 'oops', 'no'))
  const { store, actions, strokes } = begin()
  strokes.draw('branch', TRUNK, 'side')
  await actions.addPicture('side', PICTURE)
  expect(calls).toEqual([])
  expect(store.state.sheets?.side).toMatchObject({ ...WIDE, file: PICTURE, id: null })
  expect(store.strokes.side?.branches[0]?.points).toEqual(TRUNK.map(([x, y]) => [x + 450, y]))
  strokes.undo()
  strokes.redo()
  expect(store.strokes.side?.branches[0]?.points[0]?.[0]).toBe(TRUNK[0]![0] + 450)
})

test('a picture under the front is sent, since it gives the tree its colours', async () => {
  vi.stubGlobal('createImageBitmap', async () => ({ ...WIDE, close() {} }))
  service(() => Response.json({ id: 'pho_9', ...WIDE, image: '/v1/photos/pho_9/image' }, { status: 201 }))
  const { store, actions } = begin()
  await actions.addPicture('front', PICTURE)
  expect(store.state.sheets?.front).toMatchObject({ id: 'pho_9', ...WIDE })
  actions.showPicture('front', false)
  expect(store.state.sheets?.front?.hidden).toBe(true)
  actions.removePicture('front')
  expect(store.state.sheets?.front).toEqual({ id: null, ...WIDE, file: null, url: null })
})

test('a file that is not a picture leaves the sheet as it was, with the service’s fault', async () => {
  service(() => problem(422, 'format_not_allowed', 'photo: this is a PDF document; export its picture'))
  const { store } = begin()
  const actions = new SheetActions(store, new Client(), () => Promise.reject(new Error('no picture')))
  await actions.addPicture('side', PICTURE)
  expect(store.state.sheets?.side).toEqual(paper())
  expect(store.state.faults.photo?.text).toBe('This is a PDF document; export its picture.')
})

test('a picture that the browser cannot show is converted by the service, which does not keep it', async () => {
  const png = new Blob(['dots'], { type: 'image/png' })
  const calls = service(({ method, path }) => {
    if (method === 'DELETE') return new Response(null, { status: 204 })
    if (path.endsWith('/image')) return new Response(png)
    return Response.json({ id: 'pho_9', ...WIDE, image: '/v1/photos/pho_9/image' }, { status: 201 })
  })
  const { store } = begin()
  const actions = new SheetActions(store, new Client(), async file =>
    file.type === 'image/png' ? WIDE : Promise.reject(file),
  )
  await actions.addPicture('side', new File(['a photo'], 'oak.heic'))
  expect(store.state.sheets?.side).toMatchObject({ ...WIDE, id: null })
  expect(await store.state.sheets?.side?.file?.text()).toBe('dots')
  expect(calls.map(({ method, path }) => `${method} ${path}`).at(-1)).toBe('DELETE /v1/photos/pho_9')
})

test('corrections of a picture under the front are shown until something is drawn', async () => {
  const warnings = [{ code: 'photo_cut_short', stroke: 'photo', detail: 'the file is cut short' }]
  service(() => Response.json({ id: 'pho_9', ...WIDE, image: '/image', warnings }, { status: 201 }))
  const { store, actions } = begin()
  await actions.addPicture('front', new Blob(['a photo'], { type: 'image/heic' }))
  expect(store.state.corrections).toEqual({ of: store.strokes, text: 'The file is cut short.' })
})

test('choosing a brush chooses the branch tool, and each stroke on paper gets the brush’s width', () => {
  const { store, actions, strokes } = begin()
  strokes.chooseTool('crown')
  actions.chooseBrush(0.02)
  expect(store.state.tool).toBe('branch')
  strokes.draw('branch', TRUNK)
  strokes.draw('crown', LIMB)
  expect(store.strokes.branches[0]?.width).toBe(24)
  store.set({ sheets: photoSheets() })
  strokes.draw('branch', TRUNK)
  expect(store.strokes.branches[1]).not.toHaveProperty('width')
})
