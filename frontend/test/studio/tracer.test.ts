import { afterEach, expect, test, vi } from 'vitest'
import { Client } from '../../src/api/client'
import { type State, Store } from '../../src/state'
import { StrokeActions } from '../../src/studio/strokeActions'
import { Tracer } from '../../src/studio/tracer'
import {
  answer,
  CROWN,
  camera,
  captureAnswer,
  captureSheets,
  grown,
  LIMB,
  photoSheets,
  shownModel,
  TRUNK,
} from '../builders'
import { type Call, problem, service, settle } from '../service'

afterEach(() => vi.unstubAllGlobals())

async function begin() {
  const store = new Store()
  store.set({ sheets: photoSheets() })
  const wait = vi.fn(async () => {})
  const tracer = new Tracer(store, new Client(), wait)
  await settle()
  return { store, wait, tracer, strokes: new StrokeActions(store) }
}

function traced({ body }: Call): Response {
  return Response.json(answer(body.grow ? grown(body.branches.length + 1) : null))
}

test('a crown alone is traced and not grown', async () => {
  const calls = service(traced)
  const { store, strokes } = await begin()
  strokes.draw('crown', CROWN)
  await settle()
  expect(calls.map(call => call.body.grow)).toEqual([false])
  expect(store.state.traced?.of).toBe(store.strokes)
  expect(store.state.liveTree).toBeNull()
})

test('with a trunk, tracing comes first and then the live tree', async () => {
  const calls = service(traced)
  const { store, strokes } = await begin()
  strokes.draw('crown', CROWN)
  strokes.draw('branch', TRUNK)
  await settle()
  expect(calls.map(call => [call.body.branches.length, call.body.grow])).toEqual([
    [0, false],
    [1, false],
    [1, true],
  ])
  expect(store.state.liveTree).toEqual(grown(2))
  expect(store.state.tracing).toBe(false)
})

test('there is one request at a time, and of what is drawn meanwhile only the latest is traced', async () => {
  let underway = 0
  const calls = service(async call => {
    expect(++underway).toBe(1)
    await new Promise(done => setTimeout(done, 5))
    underway--
    return traced(call)
  })
  const { store, strokes } = await begin()
  strokes.draw('crown', CROWN)
  for (const line of [TRUNK, LIMB, LIMB]) strokes.draw('branch', line)
  await vi.waitFor(() => expect(store.state.liveTree).not.toBeNull())
  expect(calls.map(call => call.body.branches.length)).toEqual([0, 3, 3])
})

test('an answer for strokes that have changed since is dropped', async () => {
  let release = () => {}
  service(async call => {
    if (!call.body.branches.length) await new Promise<void>(done => (release = done))
    return traced(call)
  })
  const { store, strokes } = await begin()
  const seen = vi.fn()
  store.watch(state => state.traced, seen)
  strokes.draw('crown', CROWN)
  strokes.draw('branch', TRUNK)
  release()
  await settle()
  expect(seen.mock.calls.map(([one]) => one?.of.branches.length)).toEqual([undefined, 1])
})

test('refused strokes stay, say what is wrong with which, and are not sent again', async () => {
  const calls = service(({ body }) =>
    body.branches.length ? problem(422, 'trunk_outside_crown', 'no', '/branches/0') : traced({ body } as Call),
  )
  const { store, strokes } = await begin()
  strokes.draw('crown', CROWN)
  strokes.draw('branch', TRUNK)
  await settle()
  expect(store.state.faults.strokes?.stroke).toEqual({ kind: 'branch', index: 0 })
  expect(store.state.faults.strokes?.text).toContain('Draw it from the ground up')
  expect(store.strokes.branches).toHaveLength(1)
  expect(calls).toHaveLength(2)
  strokes.undo()
  await settle()
  expect(store.state.faults.strokes).toBeUndefined()
  strokes.redo()
  await settle()
  expect(store.state.faults.strokes?.stroke).toEqual({ kind: 'branch', index: 0 })
})

test('while the service cannot be reached it is asked again, until the strokes are traced', async () => {
  let tries = 0
  service(call => (++tries < 4 ? 'down' : traced(call)))
  const { store, wait, strokes } = await begin()
  const online = vi.fn()
  store.watch(state => state.online, online)
  strokes.draw('crown', CROWN)
  await settle()
  expect(online.mock.calls.flat()).toEqual([true, false, true])
  expect(wait).toHaveBeenCalledTimes(3)
  expect(store.state.traced).not.toBeNull()
})

test('a photo that the service no longer has is sent again', async () => {
  service(call => {
    if (call.path === '/v1/photos') return Response.json({ id: 'pho_2', width: 100, height: 100 })
    return call.path.includes('pho_2') ? traced(call) : problem(404, 'not_found', 'no such photo')
  })
  const { store, strokes } = await begin()
  strokes.draw('crown', CROWN)
  await settle()
  expect(store.state.sheets?.front?.id).toBe('pho_2')
  expect(store.state.traced).not.toBeNull()
})

test('without a trunk there is no live tree any more', async () => {
  service(traced)
  const { store, strokes } = await begin()
  strokes.draw('crown', CROWN)
  strokes.draw('branch', TRUNK)
  await settle()
  strokes.undo()
  await settle()
  expect(store.state.liveTree).toBeNull()
  strokes.clear()
  await settle()
  expect(store.state.traced).toBeNull()
})

test('the live tree comes back with its strokes: after a trunk that was deleted, and after all was cleared', async () => {
  service(traced)
  const { store, strokes } = await begin()
  strokes.draw('crown', CROWN)
  strokes.draw('branch', TRUNK)
  await settle()
  for (const takeAway of [() => strokes.clear(), () => removeTrunk()]) {
    takeAway()
    await settle()
    expect(store.state.liveTree).toBeNull()
    strokes.undo()
    await settle()
    expect(store.state.liveTree).toEqual(grown(2))
  }

  function removeTrunk() {
    strokes.select({ kind: 'branch', index: 0 })
    strokes.remove()
  }
})

test('a selected traced branch is deselected when joints get new numbers', async () => {
  service(traced)
  const { store, strokes } = await begin()
  strokes.draw('crown', CROWN)
  strokes.select({ kind: 'traced', joint: 7 })
  await settle()
  expect(store.state.selection).toBeNull()
})

test('a live tree that cannot be grown is requested once', async () => {
  const calls = service(() => Response.json(answer()))
  const { store, strokes } = await begin()
  strokes.draw('crown', CROWN)
  strokes.draw('branch', TRUNK)
  await settle()
  expect(calls.filter(call => call.body.grow)).toHaveLength(1)
  expect(store.state.liveTree).toBeNull()
})

test('strokes that a model was grown of show the model again', async () => {
  service(traced)
  const { store, strokes } = await begin()
  strokes.draw('crown', CROWN)
  strokes.draw('branch', TRUNK)
  await settle()
  store.set({ model: shownModel({}, { strokes: store.strokes }), shows: 'model' })
  strokes.draw('branch', LIMB)
  await settle()
  expect(store.state.shows).toBe('live')
  strokes.undo()
  await settle()
  expect(store.state.shows).toBe('model')
})

/** Draw a tree, and let it be traced and grown. */
async function beginDrawn() {
  const begun = await begin()
  begun.strokes.draw('crown', CROWN)
  begun.strokes.draw('branch', TRUNK)
  await settle()
  return begun
}

function choose(store: Store, changes: Partial<State['settings']>): Promise<void> {
  store.set({ settings: { ...store.state.settings, ...changes } })
  return settle()
}

test('the live tree is grown again by other settings, of what was traced', async () => {
  const calls = service(traced)
  const { store } = await beginDrawn()
  const before = calls.length
  await choose(store, { foliage: 'needles' })
  expect(calls.slice(before).map(call => [call.body.grow, call.body.settings.foliage])).toEqual([[true, 'needles']])
})

test('settings that do not change the branches leave the live tree', async () => {
  const calls = service(traced)
  const { store } = await beginDrawn()
  const before = calls.length
  await choose(store, { height: 14, leaf_size: 2, wind: 'breeze', files: ['obj'] })
  expect(calls).toHaveLength(before)
})

test('other settings leave it to the person whether the live tree or the model is shown', async () => {
  service(traced)
  const { store } = await beginDrawn()
  for (const shows of ['live', 'model'] as const) {
    store.set({ model: shownModel({}, { strokes: store.strokes }), shows })
    await choose(store, { form: shows === 'live' ? 'spire' : 'vase' })
    expect(store.state.shows).toBe(shows)
  }
})

test('a setting that the service refuses is told, and the next one is sent', async () => {
  const calls = service(call =>
    call.body.settings?.form === 'vase' ? problem(422, 'setting_not_allowed', 'no', '/settings/form') : traced(call),
  )
  const { store } = await beginDrawn()
  await choose(store, { form: 'vase' })
  expect(store.state.faults.strokes).toBeDefined()
  const before = calls.length
  await choose(store, { form: 'spire' })
  expect(calls).toHaveLength(before + 1)
  expect(store.state.faults.strokes).toBeUndefined()
})

/** Many photos with a crown and a trunk over the first, whose cameras are known or not. */
async function beginPhotos(cameras = [camera('00.jpg')]) {
  const all = await begin()
  all.store.set({ sheets: captureSheets(['00.jpg', '01.jpg'], { cameras }) })
  all.strokes.draw('crown', CROWN)
  all.strokes.draw('branch', TRUNK)
  await settle()
  return all
}

function tracedPhotos({ body }: Call): Response {
  return Response.json(captureAnswer(body.grow ? { grown: grown() } : {}))
}

test('many photos are traced once their cameras are known, and the tree grows', async () => {
  const calls = service(tracedPhotos)
  const { store } = await beginPhotos([])
  expect(calls).toEqual([])
  store.set({ sheets: captureSheets(['00.jpg', '01.jpg'], { cameras: [camera('00.jpg')] }) })
  await settle()
  expect(calls.map(({ path, body }) => [path, body.views.length, body.grow])).toEqual([
    ['/v1/captures/cap_1/trace', 1, false],
    ['/v1/captures/cap_1/trace', 1, true],
  ])
  expect(store.state.liveTree).toEqual(grown())
})

test('drawing on another photo traces nothing anew, an edit does', async () => {
  const calls = service(tracedPhotos)
  const { store, strokes } = await beginPhotos()
  const before = calls.length
  const { sheets } = store.state
  if (sheets?.source === 'capture') store.set({ sheets: { ...sheets, front: { ...sheets.front, url: 'blob:other' } } })
  await settle()
  expect(calls).toHaveLength(before)
  strokes.edit({ do: 'remove', at: [0, 1, 0] })
  await settle()
  expect(calls.at(-1)?.body.edits).toEqual([{ do: 'remove', at: [0, 1, 0] }])
})

test('a fault over one of many photos is at its stroke', async () => {
  service(() => problem(422, 'too_short', 'it is too short', '/views/0/branches/0'))
  const { store } = await beginPhotos()
  expect(store.state.faults.strokes?.stroke).toEqual({ kind: 'branch', index: 0, photo: '00.jpg' })
})

test('many photos that the service no longer has are lost, not a fault of the strokes', async () => {
  service(() => problem(404, 'capture_not_found', 'gone'))
  const { store } = await beginPhotos()
  expect(store.state.sheets).toMatchObject({ capture: { id: null } })
  expect(store.state.faults.strokes).toBeUndefined()
})

test('what failed is tried again when it is asked for', async () => {
  let fails = true
  const calls = service(call => (fails ? problem(503, 'tracing_failed', 'it took too long') : traced(call)))
  const { store, strokes, tracer } = await begin()
  strokes.draw('crown', CROWN)
  await settle()
  expect(store.state.faults.strokes?.text).toBe('It took too long.')
  fails = false
  tracer.again()
  await settle()
  expect(calls).toHaveLength(2)
  expect(store.state.faults.strokes).toBeUndefined()
})
