import { afterEach, expect, test, vi } from 'vitest'
import { Client } from '../../src/api/client'
import { clipOf } from '../../src/sheets'
import { Store } from '../../src/state'
import { Clips } from '../../src/studio/clips'
import { StrokeActions } from '../../src/studio/strokeActions'
import { text } from '../../src/text'
import { CROWN, clipInfo, clipSheets } from '../builders'
import { type Call, problem, service } from '../service'

const PART = 4 * 1024 * 1024
const video = (bytes = PART + 10) => new File([new Uint8Array(bytes)], 'ash.mp4', { type: 'video/mp4' })
const paths = (calls: readonly Call[]) => calls.map(({ method, path }) => `${method} ${path}`)

/** A service that takes a clip in parts. */
function taker() {
  let offset = 0
  return ({ method, body }: Call): Response => {
    if (method === 'POST') offset = 0
    if (method === 'PATCH') offset += (body as Blob).size
    if (method === 'PATCH' && offset > PART) return Response.json(clipInfo(), { status: 201 })
    return Response.json({ id: 'upl_1', offset, clip: null })
  }
}

function begin() {
  const store = new Store()
  const thumbnails = { of: vi.fn(async () => null) }
  const wait = vi.fn(async () => {})
  return { store, wait, thumbnails, clips: new Clips(store, new Client(), thumbnails, wait) }
}

afterEach(() => vi.unstubAllGlobals())

test('a video is sent in parts, and how much is sent is told', async () => {
  const calls = service(taker())
  const { clips, store } = begin()
  const told: (number | null)[] = []
  store.watch(
    state => state.sent,
    sent => told.push(sent),
  )
  expect(await clips.send(video())).toMatchObject({ id: 'clp_1', frames: 60 })
  expect(paths(calls)).toEqual(['POST /v1/clips?name=ash.mp4', 'PATCH /v1/uploads/upl_1', 'PATCH /v1/uploads/upl_1'])
  expect((calls[2]!.body as Blob).size).toBe(10)
  expect(told.at(-1)).toBeNull()
  expect(told.filter(Number).map(Number)[0]).toBeCloseTo(1, 4)
})

test('after a lost connection it goes on where the service is', async () => {
  const take = taker()
  let lost = 1
  const calls = service(call => (call.method === 'PATCH' && lost-- > 0 ? 'down' : take(call)))
  const { clips, store, wait } = begin()
  await clips.send(video())
  expect(paths(calls).slice(1, 3)).toEqual(['PATCH /v1/uploads/upl_1', 'GET /v1/uploads/upl_1'])
  expect([wait.mock.calls.length, store.state.online]).toEqual([1, true])
})

test('a clip whose last answer was lost is not sent twice', async () => {
  const calls = service(({ method, path }) => {
    if (method === 'PATCH') return 'down'
    if (path === '/v1/clips/clp_1') return Response.json(clipInfo())
    return Response.json({ id: 'upl_1', offset: 0, clip: method === 'GET' ? 'clp_1' : null })
  })
  expect(await begin().clips.send(video(10))).toMatchObject({ id: 'clp_1' })
  expect(paths(calls).filter(path => path.startsWith('PATCH'))).toHaveLength(1)
})

test('what the service refuses is thrown, and what was given up ends', async () => {
  const { clips, store } = begin()
  service(({ method }) =>
    method === 'PATCH'
      ? problem(422, 'clip_still', 'nothing moves')
      : Response.json({ id: 'upl_1', offset: 0, clip: null }),
  )
  await expect(clips.send(video(10))).rejects.toThrow('nothing moves')
  expect(store.state.sent).toBeNull()
  service(() => {
    clips.stop()
    return Response.json({ id: 'upl_1', offset: 0, clip: null })
  })
  await expect(clips.send(video(10))).rejects.toThrow(text.clip.givenUp)
})

test('a video that is too large is not sent', async () => {
  const calls = service(taker())
  const { clips, store } = begin()
  store.set({ limits: { clip_bytes: 5 } as never })
  await expect(clips.send(video(10))).rejects.toThrow('at most')
  expect(calls).toEqual([])
})

test('the sheet shows the frame that is chosen, and undoing leads back; the strokes stay', () => {
  const { store } = begin()
  const strokes = new StrokeActions(store)
  store.set({ sheets: clipSheets() })
  strokes.draw('crown', CROWN)
  strokes.chooseFrame(12)
  expect(store.state.sheets?.front).toMatchObject({ frame: 12, url: '/v1/clips/clp_1/frames/12' })
  expect(store.strokes.crown).toEqual(CROWN)
  strokes.undo()
  expect(store.state.sheets?.front).toMatchObject({ frame: 0, url: '/v1/clips/clp_1/frames/0' })
  strokes.redo()
  strokes.clear()
  expect(store.strokes).toMatchObject({ crown: null, frame: 12 })
})

test('a video that the service lost is sent again under the same strokes', async () => {
  service(({ method }) =>
    method === 'PATCH'
      ? Response.json(clipInfo({ id: 'clp_2', frames: 20 }))
      : Response.json({ id: 'u', offset: 0, clip: null }),
  )
  const { store, clips } = begin()
  store.set({ sheets: clipSheets({ id: null }, 30) })
  await clips.sendAgain(video(10))
  expect(clipOf(store.state)?.id).toBe('clp_2')
  expect([store.state.sheets?.front, store.strokes.frame]).toMatchObject([{ frame: 19 }, 19])
})

test('the video of a project is the one that was chosen, or comes from the service', async () => {
  const calls = service(({ method, path }) => {
    if (path.endsWith('/video')) return new Response('bytes', { headers: { 'Content-Type': 'video/mp4' } })
    return method === 'PATCH' ? Response.json(clipInfo()) : Response.json({ id: 'u', offset: 0, clip: null })
  })
  const { store, clips } = begin()
  store.set({ sheets: clipSheets() })
  expect(await (await clips.file())!.text()).toBe('bytes')
  await clips.send(video(10))
  expect((await clips.file())!.size).toBe(10)
  expect(paths(calls).filter(path => path.endsWith('/video'))).toHaveLength(1)
})
