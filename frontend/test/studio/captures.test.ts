import { afterEach, beforeEach, expect, test, vi } from 'vitest'
import { Client } from '../../src/api/client'
import type { CaptureInfo, CapturePhoto } from '../../src/api/types'
import { captureOf, photoDrawnOn } from '../../src/sheets'
import { Store } from '../../src/state'
import { Captures } from '../../src/studio/captures'
import { text } from '../../src/text'
import { answer, camera, captureInfo, capturePhoto, captureSheets, captureState } from '../builders'
import { type Call, Events, problem, service, settle } from '../service'

const NAMES = ['00.jpg', '01.jpg', '02.jpg', '03.jpg', '04.jpg']
const LIMITS = { capture_photos_min: 5, capture_photos_max: 60 } as never
const file = (name: string) => new File(['a photo'], name, { type: 'image/jpeg' })
const files = (names = NAMES) => names.map(file)

/** What the service has of the capture. */
let stored: CapturePhoto[] = []
let solved: Partial<CaptureInfo> = {}

beforeEach(() => {
  stored = []
  solved = { status: 'queued' }
  vi.stubGlobal('EventSource', Events)
  vi.stubGlobal('createImageBitmap', async () => ({ width: 100, height: 100, close() {} }))
})
afterEach(() => vi.unstubAllGlobals())

function serve({ method, path, body }: Call): Response {
  if (path.endsWith('/photos') && method === 'POST') {
    const { name } = (body as FormData).get('file') as File
    const photo = capturePhoto(name)
    stored = [...stored.filter(other => other.id !== photo.id), photo]
    return Response.json(photo, { status: 201 })
  }
  const id = path === '/v1/captures' ? 'cap_new' : path.split('/')[3]!
  return Response.json(captureInfo({ id, photos: stored, ...(path === '/v1/captures' ? {} : solved) }))
}

function begin(change = {}) {
  const store = new Store()
  store.set({ limits: LIMITS, ...change })
  const wait = vi.fn(async () => {})
  const captures = new Captures(store, new Client(), { of: async () => 'blob:small' }, wait)
  return { store, wait, captures }
}

/** All photos are sent to a capture that is open. */
async function sent(names = NAMES) {
  const all = begin()
  const { sheets, rest } = await all.captures.begin('', files(names))
  all.store.set({ sheets })
  await all.captures.send(rest)
  return all
}

const namesIn = (store: Store) => captureOf(store.state)!.photos.map(({ name }) => name)
const paths = (calls: readonly Call[]) => calls.map(({ method, path }) => `${method} ${path}`)

test('photos are sent one by one in the order of their names, then their cameras are looked for', async () => {
  const calls = service(serve)
  const { store } = await sent([...NAMES].reverse())
  expect(namesIn(store)).toEqual(NAMES)
  expect(photoDrawnOn(store.state)).toBe('00.jpg')
  expect(paths(calls).at(-1)).toBe('POST /v1/captures/cap_new/solve')
  expect(paths(calls).filter(path => path.endsWith('/photos'))).toHaveLength(5)
  expect(store.state).toMatchObject({ sending: false, solve: { status: 'queued' } })
})

test('with too few photos nothing is looked for', async () => {
  const calls = service(serve)
  await sent(NAMES.slice(0, 3))
  expect(paths(calls).some(path => path.endsWith('/solve'))).toBe(false)
})

test('a photo that cannot be read is named and left out, and the others go on', async () => {
  const isBad = ({ body }: Call) => body instanceof FormData && (body.get('file') as File).name === '02.jpg'
  service(call => (isBad(call) ? problem(422, 'photo_unreadable', 'this is no photo') : serve(call)))
  const { store } = await sent()
  expect(namesIn(store)).toEqual(['00.jpg', '01.jpg', '03.jpg', '04.jpg'])
  expect(captureOf(store.state)?.chosen).toBe(4)
  expect(store.state.notices.map(({ text }) => text)).toEqual([text.capture.refused('02.jpg', 'This is no photo.')])
})

test('where none can be read, what the service says of the last is thrown, and nothing is opened', async () => {
  service(call => (call.path.endsWith('/photos') ? problem(422, 'photo_unreadable', 'this is no photo') : serve(call)))
  await expect(begin().captures.begin('', files())).rejects.toThrow('this is no photo')
})

test('a lost connection is waited for, and no photo is left out', async () => {
  let broken = 3
  service(call => (call.path.endsWith('/photos') && stored.length === 2 && broken-- > 0 ? 'down' : serve(call)))
  const { store, wait } = await sent()
  expect(wait).toHaveBeenCalledTimes(3)
  expect(namesIn(store)).toEqual(NAMES)
  expect(store.state.online).toBe(true)
})

test('once solved, cameras, points and the use of each photo are there', async () => {
  service(serve)
  const { store } = await sent()
  const photos = stored.map(photo => ({ ...photo, used: true }))
  const cloud = { points: [], colours: [] }
  solved = { status: 'solved', photos, cameras: [camera('00.jpg')], cloud }
  Events.last.tell('progress', captureState({ id: 'cap_new', status: 'running', progress: 0.5 }))
  expect(store.state.solve).toMatchObject({ status: 'running', progress: 0.5 })
  Events.last.tell('solved', captureState({ id: 'cap_new', status: 'solved' }))
  await settle()
  expect(captureOf(store.state)).toMatchObject({ photos, cameras: [camera('00.jpg')], cloud })
  expect(store.state.solve?.status).toBe('solved')
})

test('new cameras end what was traced by others', async () => {
  service(serve)
  const { store, captures } = begin({ sheets: captureSheets(), traced: { of: {}, answer: answer() } })
  solved = { status: 'solved', photos: [capturePhoto('00.jpg')], cameras: [camera('00.jpg')] }
  store.set({ limits: { capture_photos_min: 1 } as never })
  await captures.solve()
  expect(store.state.traced).toBeNull()
})

test('another photo is drawn on, and the selection ends', () => {
  service(serve)
  const { store, captures } = begin({ sheets: captureSheets(), selection: { kind: 'crown', index: 0 } })
  captures.choose('01.jpg')
  expect(photoDrawnOn(store.state)).toBe('01.jpg')
  expect(store.state.selection).toBeNull()
  captures.choose('nowhere.jpg')
  expect(photoDrawnOn(store.state)).toBe('01.jpg')
})

test('a photo of this disk is shown from it, one of the service as that has it', async () => {
  service(serve)
  const { store, captures } = await sent()
  captures.choose('03.jpg')
  await settle()
  expect(store.state.sheets?.front.url).toMatch(/^blob:/)
  const other = begin({ sheets: captureSheets() })
  other.captures.choose('01.jpg')
  expect(other.store.state.sheets?.front.url).toBe('/v1/captures/cap_1/photos/cph_01.jpg/image')
})

test('a search that goes on is followed again after a reload', () => {
  service(serve)
  const { store, captures } = begin({ sheets: captureSheets() })
  captures.goOn(captureState({ status: 'running', progress: 0.25 }))
  expect(Events.last.url).toBe('/v1/captures/cap_1/events')
  expect(store.state.solve?.progress).toBe(0.25)
})

test('a capture that the service lost is told; photos chosen again make another, and the strokes stay', async () => {
  service(call => (call.path === '/v1/captures/cap_1/solve' ? problem(404, 'capture_not_found', 'gone') : serve(call)))
  const { store, captures } = begin({ sheets: captureSheets(NAMES) })
  await captures.solve()
  expect(captureOf(store.state)?.id).toBeNull()
  const { history } = store.state
  await captures.add(files())
  expect(captureOf(store.state)).toMatchObject({ id: 'cap_new', chosen: 5 })
  expect(namesIn(store)).toEqual(NAMES)
  expect(store.state.history).toBe(history)
})

test('photos that are added are counted once, whether they were there or not', async () => {
  service(serve)
  const { store, captures } = await sent()
  await captures.add(files(['04.jpg', '05.jpg']))
  expect(captureOf(store.state)?.chosen).toBe(6)
  expect(namesIn(store)).toEqual([...NAMES, '05.jpg'])
})

test('what another drawing replaces is not sent any more', async () => {
  const calls = service(serve)
  const { store, captures } = begin()
  const { sheets, rest } = await captures.begin('', files())
  store.set({ sheets })
  const sending = captures.send(rest)
  captures.stop()
  store.set({ sheets: null })
  await sending
  expect(paths(calls).filter(path => path.endsWith('/photos')).length).toBeLessThan(4)
  expect(store.state.sending).toBe(false)
})

test('a search that is cancelled is unsolved', async () => {
  service(serve)
  const { store, captures } = begin({ sheets: captureSheets(), solve: captureState({ status: 'running' }) })
  solved = { status: 'unsolved' }
  await captures.cancel()
  expect(store.state.solve?.status).toBe('unsolved')
})
