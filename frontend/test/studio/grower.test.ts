import { afterEach, beforeEach, expect, test, vi } from 'vitest'
import { Client } from '../../src/api/client'
import { Store } from '../../src/state'
import { Grower } from '../../src/studio/grower'
import { StrokeActions } from '../../src/studio/strokeActions'
import { CROWN, grown, model, photoSheets, TRUNK } from '../builders'
import { type Call, Events, problem, service, settle } from '../service'

const GLB = new Uint8Array([103, 108, 84, 70])

beforeEach(() => {
  Events.all = []
  vi.stubGlobal('EventSource', Events)
})
afterEach(() => {
  vi.unstubAllGlobals()
  vi.useRealTimers()
})

function begin() {
  const store = new Store()
  store.set({ sheets: photoSheets(), name: 'Oak', seed: 3 })
  const strokes = new StrokeActions(store)
  strokes.draw('crown', CROWN)
  strokes.draw('branch', TRUNK)
  return { store, strokes, grower: new Grower(store, new Client()) }
}

function serve({ method, path }: Call): Response {
  if (path.endsWith('tree.glb')) return new Response(GLB)
  if (path.endsWith('/cancel')) return Response.json(model({ status: 'canceled' }))
  return Response.json(model({ status: method === 'POST' ? 'queued' : 'running' }))
}

const finished = () => model({ status: 'succeeded', files: { 'tree.glb': '/v1/models/mdl_1/tree.glb' } })

test('a model is requested with what was drawn, followed, and its tree fetched', async () => {
  const calls = service(serve)
  const { store, grower } = begin()
  await grower.grow()
  expect(calls[0]!.body).toMatchObject({ photo: 'pho_1', name: 'Oak', seed: 3, settings: { height: 10 } })
  expect([store.state.model?.info.status, store.state.model?.strokes]).toEqual(['queued', store.strokes])
  Events.last.tell('progress', model({ status: 'running', progress: 0.4 }))
  Events.last.tell('preview', grown(5))
  expect([store.state.model?.info.progress, store.state.model?.growth]).toEqual([0.4, grown(5)])
  Events.last.tell('succeeded', finished())
  await settle()
  expect(new Uint8Array(store.state.model!.glb!)).toEqual(GLB)
  expect(Events.last.readyState).toBe(Events.CLOSED)
})

test('siblings come with a model of the same strokes, whose settings are taken over', async () => {
  const calls = service(call =>
    call.path.endsWith('.glb')
      ? new Response(GLB)
      : Response.json(model({ id: 'mdl_2', status: 'queued', seed: 9, settings: { siblings: 3 } as never })),
  )
  const { store, grower } = begin()
  grower.show(finished(), store.strokes, { leaf: null, fruit: null })
  await grower.growSiblings({ count: 3, seed: 5, scene: true, envelope: 'heart' })
  expect(calls.at(-1)).toMatchObject({
    path: '/v1/models/mdl_1/siblings',
    body: { count: 3, seed: 5, scene: true, envelope: 'heart', name: 'Oak' },
  })
  expect(store.state).toMatchObject({ model: { info: { id: 'mdl_2' }, strokes: store.strokes, sibling: 0 }, seed: 9 })
  expect(store.state.settings).toMatchObject({ siblings: 3 })
})

test('a sibling is shown in the place of the tree', async () => {
  service(({ path }) => new Response(path.includes('s2') ? new Uint8Array([2]) : GLB))
  const { store, grower } = begin()
  const files = { 'tree.glb': '/tree.glb', 'tree.s2.glb': '/tree.s2.glb' }
  grower.show(model({ status: 'succeeded', files }), store.strokes, { leaf: null, fruit: null })
  await grower.choose(1, 2)
  expect([store.state.model?.sibling, new Uint8Array(store.state.model!.glb!)]).toEqual([2, new Uint8Array([2])])
  await grower.choose(1, 7)
  expect(store.state.model?.sibling).toBe(2)
})

test('while a tree grows, growing again requests nothing', async () => {
  const calls = service(serve)
  const { grower } = begin()
  await Promise.all([grower.grow(), grower.grow()])
  await grower.grow()
  expect(calls).toHaveLength(1)
  expect(grower.isGrowing).toBe(true)
})

test('without a trunk nothing is requested', async () => {
  const calls = service(serve)
  const { strokes, grower } = begin()
  strokes.undo()
  await grower.grow()
  expect(calls).toHaveLength(0)
})

test('with a stroke at fault nothing is requested', async () => {
  const calls = service(serve)
  const { store, grower } = begin()
  store.fault('strokes', { text: 'The trunk does not reach the crown.', stroke: { kind: 'branch', index: 0 } })
  await grower.grow()
  expect([calls.length, store.state.asking]).toEqual([0, false])
})

test('a request that got lost is sent again under the same key', async () => {
  vi.useFakeTimers()
  const keys: unknown[] = []
  let tries = 0
  service(call => (++tries < 3 ? 'down' : serve(call)))
  const { fetch } = globalThis
  vi.stubGlobal('fetch', (path: string, request: RequestInit) => {
    keys.push((request.headers as Record<string, string>)['Idempotency-Key'])
    return fetch(path, request)
  })
  const { store, grower } = begin()
  const asked = grower.grow()
  await vi.runAllTimersAsync()
  await asked
  expect(new Set(keys).size).toBe(1)
  expect(keys).toHaveLength(3)
  expect(store.state.model?.info.id).toBe('mdl_1')
})

test('a refusal becomes a fault, and nothing else changes', async () => {
  service(() => problem(422, 'out_of_range', 'settings/height: 900 is too high; give 0.1 to 150', '/settings/height'))
  const { store, grower } = begin()
  await grower.grow()
  expect(store.state.faults.grow?.text).toBe('900 is too high; give 0.1 to 150.')
  expect([store.state.model, store.state.asking]).toEqual([null, false])
})

test('a failure becomes a fault in the service’s words', async () => {
  service(serve)
  const { store, grower } = begin()
  await grower.grow()
  const error = { code: 'time_limit', detail: 'It took too long.', retryable: false }
  Events.last.tell('failed', model({ status: 'failed', error }))
  expect(store.state.faults.grow?.text).toBe('It took too long.')
  expect(grower.isGrowing).toBe(false)
})

test('the page is offline from a broken connection until events arrive again', async () => {
  service(serve)
  const { store, grower } = begin()
  await grower.grow()
  Events.last.onerror()
  expect(store.state.online).toBe(false)
  Events.last.onopen()
  expect(store.state.online).toBe(true)
})

test('a model that is gone is no longer shown, with a fault', async () => {
  service(call => (call.method === 'GET' ? problem(404, 'model_not_found', 'gone') : serve(call)))
  const { store, grower } = begin()
  await grower.grow()
  Events.last.close()
  Events.last.onerror()
  await settle()
  expect([store.state.model, store.state.shows]).toEqual([null, 'live'])
  expect(store.state.faults.grow?.text).toContain('no longer there')
})

test('where too many trees are followed one asks how it is, and tries to follow it again', async () => {
  vi.useFakeTimers()
  let now = model({ status: 'running', progress: 0.5 })
  service(({ method }) => Response.json(method === 'GET' ? now : model()))
  const { store, grower } = begin()
  await grower.grow()
  const refuse = async () => {
    Events.last.close()
    Events.last.onerror()
    await vi.advanceTimersByTimeAsync(5000)
  }
  await refuse()
  expect([store.state.model?.info.progress, Events.all.length]).toEqual([0.5, 2])
  now = model({ status: 'canceled' })
  await refuse()
  expect([store.state.model?.info.status, Events.all.length]).toEqual(['canceled', 2])
})

test('a canceled tree is no longer growing', async () => {
  const calls = service(serve)
  const { store, grower } = begin()
  await grower.grow()
  await grower.cancel()
  expect(calls.at(-1)!.path).toBe('/v1/models/mdl_1/cancel')
  expect([store.state.model?.info.status, grower.isGrowing]).toEqual(['canceled', false])
})

test('another model replaces the followed one, whose late tree is not shown', async () => {
  service(serve)
  const { store, grower } = begin()
  await grower.grow()
  const first = Events.last
  first.tell('succeeded', finished())
  grower.show(model({ id: 'mdl_2' }), store.strokes, { leaf: null, fruit: null })
  await settle()
  expect(first.readyState).toBe(Events.CLOSED)
  expect([store.state.model?.info.id, store.state.model?.glb]).toEqual(['mdl_2', null])
})

test('another tree of the same strokes has another seed', async () => {
  const calls = service(serve)
  const { store, grower } = begin()
  await grower.reroll()
  expect(calls[0]!.body.seed).toBe(store.state.seed)
  expect(store.state.seed).not.toBe(3)
})

test('an own picture of a leaf is sent with the request, whole', async () => {
  const calls = service(serve)
  const { store, grower } = begin()
  const bytes = Uint8Array.from({ length: 100_000 }, (_, at) => at % 251)
  const leaf = new Blob([bytes])
  store.set({ leaf })
  await grower.grow()
  expect(Buffer.from(calls[0]!.body.leaf, 'base64').equals(Buffer.from(bytes))).toBe(true)
  expect(store.state.model?.leaf).toBe(leaf)
  Events.last.tell('canceled', model({ status: 'canceled' }))
  store.set({ leaf: null })
  await grower.grow()
  expect(calls.at(-1)!.body).not.toHaveProperty('leaf')
})

test('another of the model’s trees is fetched once, and the last choice is shown', async () => {
  const calls = service(({ path }) => new Response(path))
  const { store, grower } = begin()
  const files = { 'tree.glb': '/tree.glb', 'tree.v2.glb': '/tree.v2.glb' }
  grower.show(model({ status: 'succeeded', files }), store.strokes, { leaf: null, fruit: null })
  const shown = () => new TextDecoder().decode(store.state.model!.glb!)
  await Promise.all([grower.choose(2), grower.choose(1), grower.choose(2)])
  expect([store.state.model?.variant, shown()]).toEqual([2, '/tree.v2.glb'])
  const asked = calls.length
  await grower.choose(1)
  await grower.choose(3)
  expect([store.state.model?.variant, shown(), calls.length]).toEqual([1, '/tree.glb', asked])
  grower.show(model({ id: 'mdl_2' }), store.strokes, { leaf: null, fruit: null })
  expect([store.state.model?.variant, store.state.model?.glb]).toEqual([1, null])
})
