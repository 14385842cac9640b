import 'fake-indexeddb/auto'
import { IDBFactory } from 'fake-indexeddb'
import { afterEach, beforeEach, expect, test, vi } from 'vitest'
import { DEFAULT_SETTINGS } from '../../src/api/defaults'
import { clipOf } from '../../src/sheets'
import { NO_STROKES } from '../../src/strokes'
import { readProject, writeProject } from '../../src/studio/project'
import { Studio } from '../../src/studio/studio'
import { CROWN, clipAnswer, clipInfo, model } from '../builders'
import { type Call, Events, problem, service, settle } from '../service'

const DRAWN = { ...NO_STROKES, crown: CROWN, frame: 7 }
const video = () => new File(['a video'], 'ash.mov', { type: 'video/quicktime' })
const project = () =>
  writeProject({ photo: null, clip: video(), strokes: DRAWN, settings: DEFAULT_SETTINGS, seed: 2, leaf: null })

async function serve({ method, path }: Call): Promise<Response> {
  if (path.endsWith('/trace')) return Response.json(clipAnswer())
  if (path === '/project') return new Response(await project())
  if (path.includes('/frames/')) return new Response(new Blob(['a frame'], { type: 'image/jpeg' }))
  if (path.startsWith('/v1/uploads')) return Response.json(clipInfo({ id: 'clp_sent' }), { status: 201 })
  if (path.startsWith('/v1/clips?')) return Response.json({ id: 'upl_1', offset: 0, clip: null }, { status: 201 })
  if (path.startsWith('/v1/clips/')) return Response.json(clipInfo({ id: path.split('/')[3]! }))
  const files = { project: '/project' }
  return Response.json(model({ clip: 'clp_1', status: method === 'POST' ? 'queued' : 'succeeded', files }))
}

const lost = (id: string) => (call: Call) =>
  call.path === `/v1/clips/${id}` ? problem(404, 'not_found', 'gone') : serve(call)

beforeEach(() => {
  globalThis.indexedDB = new IDBFactory()
  vi.stubGlobal('EventSource', Events)
  vi.stubGlobal('createImageBitmap', async () => ({ width: 100, height: 100, close() {} }))
})
afterEach(() => vi.unstubAllGlobals())

test('a video is sent and opened at its first frame, under its name', async () => {
  service(serve)
  const { store, opener } = new Studio()
  await opener.openClip(video())
  expect(store.state).toMatchObject({ name: 'ash', tool: 'crown', sheets: { source: 'clip', front: { frame: 0 } } })
  expect(store.state.sheets?.front.url).toBe('/v1/clips/clp_sent/frames/0')
})

test('what was noted while a video was read is said', async () => {
  const notes = [{ code: 'clip_cut', stroke: null, detail: 'only the first 60 seconds are used' }] as never
  service(call => (call.method === 'PATCH' ? Response.json(clipInfo({ notes }), { status: 201 }) : serve(call)))
  const { store, opener } = new Studio()
  await opener.openClip(video())
  expect(store.state.corrections?.text).toContain('nly the first 60 seconds are used')
})

test('what the service refuses is said, and nothing is opened', async () => {
  service(call => (call.method === 'PATCH' ? problem(422, 'clip', 'nothing moves in this clip') : serve(call)))
  const { store, opener } = new Studio()
  await opener.openClip(video())
  expect([store.state.sheets, store.state.faults.photo?.text]).toEqual([null, expect.stringContaining('moves')])
})

test('a crown over a frame is traced, and is enough for a tree', async () => {
  const calls = service(serve)
  const { store, opener, strokes, grower } = new Studio()
  await opener.openClip(video())
  strokes.chooseFrame(7)
  strokes.draw('crown', CROWN)
  await settle()
  const traced = calls.find(({ path }) => path.endsWith('/trace'))!
  expect(traced).toMatchObject({ path: '/v1/clips/clp_sent/trace', body: { frame: 7, crown: {}, grow: false } })
  expect(store.state.traced?.answer).toHaveProperty('tracks')
  await grower.grow()
  expect(calls.at(-1)?.body).toMatchObject({ clip: 'clp_sent', strokes: { frame: 7 } })
})

test('a project with a video is read as it was written', async () => {
  const read = await readProject(await project(), () => Promise.reject(new Error('no sketch')))
  expect([read.clip?.name, read.clip?.type, await read.clip?.text()]).toEqual([
    'clip.mov',
    'video/quicktime',
    'a video',
  ])
  expect([read.photo, read.strokes, read.seed]).toEqual([null, DRAWN, 2])
})

test('a project with a video is opened: the video is sent', async () => {
  service(serve)
  const { store, opener } = new Studio()
  await opener.openFile(new File([await project()], 'old ash.treestroke'))
  expect(store.state).toMatchObject({ name: 'old ash', seed: 2, sheets: { front: { id: 'clp_sent', frame: 7 } } })
})

test('a model of a clip is opened with it; where the service lost it, its video is sent again', async () => {
  service(serve)
  const { store, opener } = new Studio()
  await opener.openModel('mdl_1')
  expect(store.state).toMatchObject({
    sheets: { front: { id: 'clp_1', frame: 7 } },
    model: { info: { clip: 'clp_1' } },
  })
  service(lost('clp_1'))
  await opener.openModel('mdl_1')
  expect(clipOf(store.state)?.id).toBe('clp_sent')
})

test('a draft of a clip opens again; where the service lost the clip, it is asked for', async () => {
  service(serve)
  const before = new Studio()
  await before.opener.openClip(video())
  before.strokes.draw('crown', CROWN)
  before.strokes.chooseFrame(7)
  await vi.waitFor(async () => expect((await before.drafts.list())[0]?.history.present.frame).toBe(7))
  const { id } = (await before.drafts.list())[0]!
  const after = new Studio()
  await after.opener.openDraft(id)
  expect(after.store.state.sheets).toMatchObject({ source: 'clip', front: { id: 'clp_sent', frame: 7 } })
  expect(after.store.strokes.crown).toEqual(CROWN)
  service(lost('clp_sent'))
  const later = new Studio()
  await later.opener.openDraft(id)
  expect(clipOf(later.store.state)?.id).toBeNull()
  expect(later.store.state.sheets?.front).toMatchObject({ frame: 7, url: null })
})
