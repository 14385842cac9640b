import 'fake-indexeddb/auto'
import { IDBFactory } from 'fake-indexeddb'
import { strToU8, zipSync } from 'fflate'
import { afterEach, beforeEach, expect, test, vi } from 'vitest'
import { DEFAULT_SETTINGS } from '../../src/api/defaults'
import type { Limits } from '../../src/api/types'
import { captureOf } from '../../src/sheets'
import { NO_STROKES, onPhoto, toWire, viewsToWire, withPhoto } from '../../src/strokes'
import { writeProject } from '../../src/studio/project'
import { Studio } from '../../src/studio/studio'
import { text } from '../../src/text'
import {
  answer,
  CROWN,
  captureInfo,
  capturePhoto,
  drawnAnswer,
  LIMB,
  model,
  PNG,
  sketchAnswer,
  TRUNK,
} from '../builders'
import { type Call, Events, problem, service, settle } from '../service'

const STROKES = { crown: CROWN, branches: [{ points: TRUNK }], erase: [], scale: null }
const PHOTO = { id: 'pho_1', width: 100, height: 100, image: '/v1/photos/pho_1/image' }
const jpeg = (name = 'Old oak.jpg', content = 'a photo') => new File([content], name, { type: 'image/jpeg' })

beforeEach(() => {
  globalThis.indexedDB = new IDBFactory()
  vi.stubGlobal('EventSource', Events)
  vi.stubGlobal('createImageBitmap', async () => ({ width: 100, height: 100, close() {} }))
})
afterEach(() => vi.unstubAllGlobals())

const made = (leaf: Blob | null = null, photo = jpeg()) =>
  writeProject({ photo, strokes: STROKES, settings: DEFAULT_SETTINGS, seed: 0, leaf })

async function serve({ method, path }: Call): Promise<Response> {
  if (path === '/v1/photos') return Response.json(PHOTO, { status: 201 })
  if (path === '/v1/sketches/trace') return Response.json(sketchAnswer())
  if (path.endsWith('/trace')) return Response.json(answer())
  if (path === '/project') return new Response(await made())
  if (path.endsWith('.jpg') || path.endsWith('/image')) return new Response(jpeg())
  if (path.startsWith('/v1/photos/')) return Response.json(PHOTO)
  const status = method === 'POST' ? 'queued' : 'succeeded'
  const files = { project: '/project' }
  return Response.json(model({ status, files, seed: 5, settings: { ...DEFAULT_SETTINGS, height: 14 } }))
}

test('a photo is opened under its name, upright as the browser shows it', async () => {
  service(serve)
  const { store, opener } = new Studio()
  await opener.openFile(jpeg())
  expect(store.state).toMatchObject({
    name: 'Old oak',
    opening: false,
    tool: 'crown',
    sheets: { front: { id: 'pho_1' } },
  })
  expect(store.state.sheets?.front?.url).toMatch(/^blob:/)
})

test('a picture that the browser decodes to another size is shown as the service has it', async () => {
  service(serve)
  vi.stubGlobal('createImageBitmap', async () => ({ width: 60, height: 80, close() {} }))
  const { store, opener } = new Studio()
  await opener.openFile(jpeg())
  expect(store.state.sheets?.front?.url).toBe(PHOTO.image)
})

test.each(['oak.HEIC', 'oak.tif', 'oak.avif'])(
  '%s is sent whatever the browser knows of it, and shown as the service has it',
  async name => {
    service(serve)
    const { store, opener } = new Studio()
    await opener.openFile(new File(['a photo'], name))
    expect(store.state.sheets?.front?.url).toBe(PHOTO.image)
    expect(store.state.sheets?.front?.file?.type).toMatch(/^image\/(heic|tiff|avif)$/)
  },
)

test('corrections of a photo are shown when it opens', async () => {
  const detail = "the photo's file is cut short, but nothing of its picture is missing; copy it again"
  const warnings = [{ code: 'photo_cut_short', stroke: 'photo', detail }]
  service(call => (call.path === '/v1/photos' ? Response.json({ ...PHOTO, warnings }, { status: 201 }) : serve(call)))
  const { store, opener } = new Studio()
  await opener.openFile(jpeg())
  expect(store.state.corrections).toEqual({
    of: store.strokes,
    text: "The photo's file is cut short, but nothing of its picture is missing; copy it again.",
  })
})

test('a file that is not a photo leaves the drawing as it was', async () => {
  let good = true
  service(call => (good ? serve(call) : problem(422, 'photo_unreadable', 'photo: it is no picture; save it as JPEG')))
  const { store, opener, strokes } = new Studio()
  await opener.openFile(jpeg())
  strokes.draw('crown', CROWN)
  const before = store.state
  good = false
  await opener.openFile(new File(['text'], 'notes.txt'))
  expect(store.state.faults.photo?.text).toBe('It is no picture; save it as JPEG.')
  expect([store.state.sheets?.front, store.strokes]).toEqual([before.sheets?.front, before.history.present])
})

test('a file that is too large is not sent', async () => {
  const calls = service(serve)
  const { store, opener } = new Studio()
  store.set({ limits: { photo_bytes: 5 } as Limits })
  await opener.openFile(jpeg())
  expect(store.state.faults.photo?.text).toContain('at most')
  expect(calls).toHaveLength(0)
})

test('a project is opened with its strokes, settings and seed', async () => {
  service(serve)
  const { store, opener } = new Studio()
  const settings = { ...DEFAULT_SETTINGS, leaf_size: 2 }
  const file = await writeProject({ photo: jpeg(), strokes: STROKES, settings, seed: 9, leaf: null })
  await opener.openFile(new File([file], 'Maple.treestroke'))
  expect(store.state).toMatchObject({ name: 'Maple', settings, seed: 9, tool: 'branch' })
  expect(store.strokes).toEqual(STROKES)
})

test('an example is opened with its strokes and grown', async () => {
  const calls = service(call => (call.path.endsWith('x.json') ? Response.json(toWire(STROKES)) : serve(call)))
  const { store, opener } = new Studio()
  await opener.openExample({ name: 'oak_02', photo: '/page/x.jpg', strokes: '/page/x.json' })
  await vi.waitFor(() => expect(store.state.model?.info.status).toBe('queued'))
  expect(store.state.name).toBe('Young oak')
  expect(calls.find(call => call.path === '/v1/models')!.body.strokes).toEqual(toWire(STROKES))
})

test('a model is opened with the strokes, settings and seed that it was made of', async () => {
  service(serve)
  const { store, opener } = new Studio()
  await opener.openModel('mdl_1')
  expect(store.state).toMatchObject({
    name: 'Oak',
    seed: 5,
    settings: { height: 14 },
    model: { info: { id: 'mdl_1' } },
  })
  expect(store.state.model?.strokes).toBe(store.strokes)
})

test('a model whose photo was deleted is opened with its own copy', async () => {
  const calls = service(call => {
    return call.path === '/v1/photos/pho_1' ? problem(404, 'not_found', 'no such photo') : serve(call)
  })
  const { store, opener } = new Studio()
  await opener.openModel('mdl_1')
  expect(calls.some(({ method, path }) => method === 'POST' && path === '/v1/photos')).toBe(true)
  expect(await store.state.sheets?.front.file?.text()).toBe('a photo')
})

test('a model that is gone is a fault', async () => {
  service(() => problem(404, 'not_found', 'no such model'))
  const { store, opener } = new Studio()
  await opener.openModel('mdl_1')
  expect(store.state.faults.photo?.text).toContain('no longer there')
})

const NAMES = ['00.jpg', '01.jpg']
const VIEWS = withPhoto(NO_STROKES, '01.jpg', STROKES)

/** A service with a capture of two photos, and a model of it with its project. */
async function serveCapture(call: Call): Promise<Response> {
  const { method, path, body } = call
  const photos = NAMES.map(name => capturePhoto(name, { used: true }))
  if (path.endsWith('/photos') && method === 'POST')
    return Response.json(capturePhoto(((body as FormData).get('file') as File).name), { status: 201 })
  if (path.startsWith('/v1/captures')) return Response.json(captureInfo({ photos, status: 'solved' }))
  const photosMade = NAMES.map(name => new File(['dots'], name, { type: 'image/png' }))
  const project = { photo: null, photos: photosMade, strokes: VIEWS, settings: DEFAULT_SETTINGS, seed: 0, leaf: null }
  if (path === '/project') return new Response(await writeProject(project))
  return Response.json(model({ capture: 'cap_1', status: 'succeeded', files: { project: '/project' } }))
}

test('many photos are opened with the first one, and the others follow', async () => {
  service(serveCapture)
  const { store, opener } = new Studio()
  await opener.openPhotos([jpeg('01.jpg'), jpeg('00.jpg')], 'The oak')
  await settle()
  expect(store.state).toMatchObject({ name: 'The oak', opening: false, sheets: { front: { name: '00.jpg' } } })
  expect(captureOf(store.state)?.photos.map(({ name }) => name)).toEqual(NAMES)
})

test('an example of many photos comes with its strokes', async () => {
  const strokes = new File([JSON.stringify(viewsToWire(VIEWS))], 'strokes.json')
  service(call => (call.path === '/strokes.json' ? new Response(strokes) : serveCapture(call)))
  const { store, opener } = new Studio()
  const photos = NAMES.map(name => ({ name, url: `/${name}/image` }))
  await opener.openPhotosExample({ name: 'young_ash', photos, strokes: '/strokes.json' })
  expect(store.strokes).toEqual(VIEWS)
  expect(store.state.name).toBe(text.examples.young_ash)
})

test('a model of many photos is opened over those that the service has, at the photo that was drawn on', async () => {
  const calls = service(serveCapture)
  const { store, opener } = new Studio()
  await opener.openModel('mdl_1')
  expect(store.strokes).toEqual(VIEWS)
  expect(store.state.sheets).toMatchObject({ source: 'capture', front: { name: '01.jpg' } })
  expect(store.state.model?.strokes).toBe(store.strokes)
  expect(calls.filter(({ method }) => method === 'POST')).toEqual([])
})

test('where the service no longer has its photos, they are sent again from its project', async () => {
  const isLost = ({ path, method }: Call) => path === '/v1/captures/cap_1' && method === 'GET'
  service(call => (isLost(call) ? problem(404, 'capture_not_found', 'gone') : serveCapture(call)))
  const { store, opener } = new Studio()
  await opener.openModel('mdl_1')
  await settle()
  expect(captureOf(store.state)?.photos.map(({ name }) => name)).toEqual(NAMES)
  expect(store.strokes).toEqual(VIEWS)
  expect(store.state.model?.info.id).toBe('mdl_1')
})

/** A draft of two photos that was left at the second. */
async function keptCapture(): Promise<string> {
  const { opener, captures, strokes, drafts } = new Studio()
  await opener.openPhotos(
    NAMES.map(name => jpeg(name)),
    '',
  )
  await settle()
  captures.choose('01.jpg')
  strokes.draw('crown', CROWN)
  await vi.waitFor(async () => expect((await drafts.find(drafts.id!))?.draft.history.past).toHaveLength(1))
  return drafts.id!
}

test('a draft of many photos goes on where it was left', async () => {
  service(serveCapture)
  const id = await keptCapture()
  const { store, opener } = new Studio()
  await opener.openDraft(id)
  expect(store.state.sheets).toMatchObject({ source: 'capture', front: { name: '01.jpg' } })
  expect(onPhoto(store.strokes, '01.jpg').crown).toEqual(CROWN)
  expect(store.state.solve?.status).toBe('solved')
})

test('a draft whose photos the service lost keeps its strokes and asks for the photos', async () => {
  service(serveCapture)
  const id = await keptCapture()
  service(() => problem(404, 'capture_not_found', 'gone'))
  const { store, opener } = new Studio()
  await opener.openDraft(id)
  expect(captureOf(store.state)).toMatchObject({ id: null, photos: [{ name: '00.jpg' }, { name: '01.jpg' }] })
  expect(onPhoto(store.strokes, '01.jpg').crown).toEqual(CROWN)
})

test('a draft is opened with its history and its model', async () => {
  service(serve)
  const before = new Studio()
  await before.opener.openFile(jpeg())
  before.strokes.draw('crown', CROWN)
  before.strokes.draw('branch', TRUNK)
  await before.grower.grow()
  const id = before.drafts.id!
  await vi.waitFor(async () => expect((await before.drafts.find(id))?.draft.model).toBe('mdl_1'))
  const { store, opener } = new Studio()
  await opener.openDraft(id)
  expect(store.state.history).toEqual(before.store.state.history)
  expect(store.state).toMatchObject({ name: 'Old oak', model: { info: { id: 'mdl_1' } } })
  expect(store.state.model?.strokes).toEqual(store.strokes)
})

test('closing leaves nothing open and keeps the drawing', async () => {
  service(serve)
  const { store, opener, drafts, strokes } = new Studio()
  await opener.openFile(jpeg())
  strokes.draw('crown', CROWN)
  const id = drafts.id!
  await vi.waitFor(async () => expect((await drafts.find(id))?.draft.history.past).toHaveLength(1))
  opener.close()
  expect([store.state.sheets, store.state.model]).toEqual([null, null])
  expect((await drafts.list()).map(draft => draft.id)).toEqual([id])
})

test('an own picture of a leaf is opened with a project, a model and a draft', async () => {
  service(async call => (call.path === '/project' ? new Response(await made(new Blob(['a leaf']))) : serve(call)))
  const { store, opener, drafts } = new Studio()
  await opener.openFile(new File([await made(new Blob(['mine']))], 'Maple.treestroke'))
  expect(await store.state.leaf?.text()).toBe('mine')
  const id = drafts.id!
  await vi.waitFor(async () => expect(await (await drafts.find(id))?.leaf?.text()).toBe('mine'))
  await opener.openModel('mdl_1')
  expect(await store.state.leaf?.text()).toBe('a leaf')
  expect(store.state.model?.leaf).toBe(store.state.leaf)
  await opener.openDraft(id)
  expect(await store.state.leaf?.text()).toBe('mine')
})

test('a draft on paper is opened with both sheets, the side’s picture and the fruit', async () => {
  const calls = service(serve)
  const before = new Studio()
  await before.opener.openPaper()
  before.strokes.draw('branch', TRUNK)
  before.strokes.draw('branch', TRUNK, 'side')
  await before.sheets.addPicture('side', jpeg('side.jpg', 'a guide'))
  before.store.set({ fruit: new Blob(['a pear']) })
  const id = before.drafts.id!
  await vi.waitFor(async () => expect(await (await before.drafts.find(id))?.fruit?.text()).toBe('a pear'))
  const { store, opener } = new Studio()
  await opener.openDraft(id)
  expect(store.state).toMatchObject({
    sheets: { source: 'sketch', front: { id: null, width: 900, height: 1200, url: null } },
  })
  expect(store.state.sheets?.side).toMatchObject({ width: 100, height: 100 })
  expect(await store.state.sheets?.side?.file?.text()).toBe('a guide')
  expect(store.state.history).toEqual(before.store.state.history)
  expect(calls.some(({ path }) => path === '/v1/photos')).toBe(false)
})

test('an example from two sides is opened on paper of its size and grown, with its fruit and settings', async () => {
  const sketch = { canvas: [1200, 1100], branches: [{ points: TRUNK }] }
  const calls = service(call => {
    if (call.path.endsWith('.json')) return Response.json(sketch)
    return call.path.endsWith('.png') ? new Response('a pear') : serve(call)
  })
  const { store, opener } = new Studio()
  const urls = { front: '/page/f.json', side: '/page/s.json', leaf: undefined, fruit: '/page/fruit.png' }
  await opener.openSketches({ name: 'pear', ...urls, settings: { height: 8 } })
  await vi.waitFor(() => expect(store.state.model?.info.status).toBe('queued'))
  expect(store.state).toMatchObject({
    name: 'Pear tree',
    tool: 'branch',
    sheets: { side: { width: 1200, height: 1100 } },
  })
  const { body } = calls.find(call => call.path === '/v1/models')!
  expect(body).toMatchObject({
    sketches: { front: sketch, side: sketch },
    fruit: btoa('a pear'),
    settings: { height: 8 },
  })
})

test('sketches over a photo are fitted to its size', async () => {
  service(serve)
  const strokes = { ...NO_STROKES, branches: [{ points: TRUNK }] }
  const sizes = { front: { width: 200, height: 200 } }
  const file = await writeProject({ photo: jpeg(), strokes, sizes, settings: DEFAULT_SETTINGS, seed: 0, leaf: null })
  const { store, opener } = new Studio()
  await opener.openFile(new File([file], 'Pear.treestroke'))
  expect(store.state).toMatchObject({
    sheets: { source: 'sketch', front: { id: 'pho_1', width: 100 }, side: { height: 100 } },
  })
  expect(store.strokes.branches[0]?.points).toEqual(TRUNK.map(([x, y]) => [x / 2, y / 2]))
})

const png = (name = 'Oak.png') => new File([PNG], name, { type: 'image/png' })
const READ = {
  crown: null,
  branches: [
    { points: TRUNK, width: 10 },
    {
      points: [
        [50, 70],
        [70, 50],
      ],
      width: 4,
    },
  ],
}
const isReading = ({ path, body }: Call) => path === '/v1/sketches/trace' && 'picture' in body.front
const reads = (call: Call) => (isReading(call) ? Response.json(drawnAnswer()) : serve(call))

test('a sketch that is a picture is opened as strokes on paper of its size', async () => {
  const calls = service(reads)
  const { store, opener } = new Studio()
  await opener.openSketch(png())
  expect(store.state).toMatchObject({
    name: 'Oak',
    tool: 'branch',
    sheets: { source: 'sketch', front: { width: 100, url: null } },
  })
  expect(store.state.sheets?.side).toMatchObject({ height: 100 })
  expect(store.strokes).toMatchObject(READ)
  expect(calls.find(isReading)!.body).toEqual({ front: { picture: Buffer.from(PNG).toString('base64') }, grow: false })
})

test('a sketch that is JSON is opened without the service', async () => {
  const calls = service(serve)
  const { store, opener } = new Studio()
  const sketch = { canvas: [200, 300], branches: [{ points: TRUNK }] }
  await opener.openSketch(new File([JSON.stringify(sketch)], 'oak.front.json'))
  expect(store.state.sheets?.front).toMatchObject({ width: 200, height: 300 })
  expect(calls.some(isReading)).toBe(false)
})

test('a sketch replaces a sheet’s strokes, which an undo brings back', async () => {
  service(reads)
  const { store, opener, strokes } = new Studio()
  await opener.openPaper()
  strokes.draw('branch', TRUNK)
  strokes.draw('branch', LIMB, 'side')
  await opener.openOn('side', png())
  expect(store.strokes.side).toEqual(READ)
  expect(store.state).toMatchObject({
    active: 'side',
    sheets: { side: { width: 100, height: 100 }, front: { width: 900 } },
  })
  expect(store.strokes.branches).toEqual([{ points: TRUNK }])
  strokes.undo()
  expect(store.strokes.side?.branches).toHaveLength(1)
})

test('a sketch on a sheet with a photo is fitted to the photo', async () => {
  vi.stubGlobal('createImageBitmap', async () => ({ width: 400, height: 200, close() {} }))
  service(reads)
  const { store, opener, sheets } = new Studio()
  await opener.openPaper()
  await sheets.addPicture('side', jpeg())
  await opener.openOn('side', png())
  expect(store.state.sheets?.side).toMatchObject({ width: 400, height: 200 })
  expect(store.strokes.side?.branches[0]).toEqual({ points: TRUNK.map(([x, y]) => [100 + 2 * x, 2 * y]), width: 20 })
})

test('corrections of a sketch are shown until something is drawn', async () => {
  const warnings = [{ code: 'loop_cut', stroke: 'front/picture', detail: 'a loop was cut open at (9, 9)' }]
  service(call => (isReading(call) ? Response.json({ ...drawnAnswer(), warnings }) : serve(call)))
  const { store, opener } = new Studio()
  await opener.openSketch(png())
  expect(store.state.corrections?.of).toBe(store.strokes)
  expect(store.state.corrections?.text).toBe('Front: 1 loop of branches was cut open.')
})

test.each([
  ['the service’s refusal', png(), 'Draw the tree'],
  ['neither a PNG nor strokes', jpeg(), 'Save it as a PNG'],
  ['a PNG that is too large', new File([PNG, new Uint8Array(90)], 'large.png'), 'at most'],
])('%s is said and leaves the sheets as they were', async (_, file, word) => {
  const refusal = problem(422, 'sketch_empty', 'front/picture: the picture shows no strokes. Draw the tree')
  service(call => (isReading(call) ? refusal : serve(call)))
  const { store, opener, strokes } = new Studio()
  await opener.openPaper()
  store.set({ limits: { sketch_bytes: 50 } as Limits })
  strokes.draw('branch', TRUNK)
  const { sheets, history } = store.state
  await opener.openOn('front', file)
  expect(store.state.faults.photo?.text).toContain(word)
  expect(store.state).toMatchObject({ opening: false })
  expect([store.state.sheets, store.state.history]).toEqual([sheets, history])
})

test('the last file is opened, even if an earlier one takes longer', async () => {
  let first: (answer: Response) => void = () => {}
  let count = 0
  service(call => {
    if (!isReading(call)) return serve(call)
    return count++ === 0 ? new Promise<Response>(done => (first = done)) : Response.json(drawnAnswer())
  })
  const { store, opener } = new Studio()
  const slow = opener.openSketch(png('slow.png'))
  await settle()
  expect(store.state.opening).toBe(true)
  await opener.openSketch(png('quick.png'))
  first(problem(422, 'sketch_empty', 'nothing is drawn'))
  await slow
  expect(store.state).toMatchObject({ name: 'quick', opening: false, faults: {} })
})

test('a drawing that is closed while another is read stays closed', async () => {
  let answered: (answer: Response) => void = () => {}
  service(call => (isReading(call) ? new Promise<Response>(done => (answered = done)) : serve(call)))
  const { store, opener } = new Studio()
  await opener.openPaper()
  const reading = opener.openOn('front', png())
  await settle()
  opener.close()
  answered(Response.json(drawnAnswer()))
  await reading
  expect(store.state).toMatchObject({ sheets: null, opening: false })
})

test('an example of pictures is opened as strokes, and grown', async () => {
  const calls = service(call => (call.path.endsWith('.png') ? new Response(PNG) : reads(call)))
  const { store, opener } = new Studio()
  const urls = { front: '/page/f.png', side: '/page/s.png', leaf: undefined, fruit: undefined }
  await opener.openSketches({ name: 'imagined', ...urls, settings: { height: 6 } })
  await vi.waitFor(() => expect(store.state.model?.info.status).toBe('queued'))
  expect(store.state).toMatchObject({ name: 'Imagined tree', sheets: { side: { width: 100, height: 100 } } })
  const { sketches } = calls.find(({ path }) => path === '/v1/models')!.body
  expect(sketches.front).toEqual({ canvas: [100, 100], branches: READ.branches })
  expect(sketches.side).toEqual(sketches.front)
})

test('a model and a project of pictures are opened as strokes to draw on', async () => {
  const settings = strToU8('{"height": 6}')
  const project = zipSync({ 'front.png': PNG, 'side.png': PNG, 'settings.json': settings })
  service(call => (call.path === '/project' ? new Response(new Uint8Array(project)) : reads(call)))
  const { store, opener, strokes } = new Studio()
  await opener.openModel('mdl_1')
  expect(store.state).toMatchObject({ sheets: { source: 'sketch' }, model: { info: { id: 'mdl_1' } } })
  expect(store.state.model?.strokes).toBe(store.strokes)
  expect(store.strokes).toEqual({ ...NO_STROKES, ...READ, side: READ })
  strokes.draw('branch', LIMB, 'side')
  expect(store.strokes.side?.branches).toHaveLength(3)
  await opener.openFile(new File([new Uint8Array(project)], 'Imagined.treestroke'))
  expect(store.state).toMatchObject({ name: 'Imagined', model: null, settings: { height: 6 } })
  expect(store.strokes).toEqual({ ...NO_STROKES, ...READ, side: READ })
})
