import { afterEach, beforeEach, expect, test, vi } from 'vitest'
import { Client } from '../../src/api/client'
import { Store } from '../../src/state'
import { Grower } from '../../src/studio/grower'
import { StrokeActions } from '../../src/studio/strokeActions'
import { TakenActions } from '../../src/studio/takenActions'
import { CROWN, grown, model, photoSheets, shownModel, TRUNK } from '../builders'
import { type Call, Events, service, settle } from '../service'

beforeEach(() => vi.stubGlobal('EventSource', Events))
afterEach(() => vi.unstubAllGlobals())

function begin() {
  const calls = service(serve)
  const store = new Store()
  store.set({ sheets: photoSheets() })
  const strokes = new StrokeActions(store)
  strokes.draw('crown', CROWN)
  strokes.draw('branch', TRUNK)
  return { calls, store, taken: new TakenActions(store, new Grower(store, new Client())) }
}

function serve({ path, body }: Call): Response {
  if (path.endsWith('/cancel')) return Response.json(model({ status: 'canceled' }))
  return Response.json(model({ id: 'mdl_2', settings: body.settings }))
}

const sent = (calls: Call[]) => calls.map(({ path }) => path)
const grownTree = (settings = {}) => shownModel({ status: 'succeeded', settings }, { glb: new ArrayBuffer(4) })

test('what is chosen is a setting; without a model none is requested', async () => {
  const { calls, store, taken } = begin()
  expect(taken.take('foliage', 'needles')).toBe(true)
  expect(taken.take('form', 'spire')).toBe(true)
  await settle()
  expect(store.state.settings).toMatchObject({ foliage: 'needles', form: 'spire' })
  expect(sent(calls)).toEqual([])
})

test('a model that is shown is made again', async () => {
  const { calls, store, taken } = begin()
  store.set({ model: grownTree(), shows: 'model' })
  taken.take('foliage', 'needles')
  await settle()
  expect(sent(calls)).toEqual(['/v1/models'])
  expect(calls[0]!.body.settings.foliage).toBe('needles')
  expect(store.state.model?.info.id).toBe('mdl_2')
})

test('a model that is under way is replaced', async () => {
  const { calls, store, taken } = begin()
  store.set({ model: shownModel({ status: 'running' }), shows: 'model' })
  taken.take('foliage', 'needles')
  await settle()
  expect(sent(calls)).toEqual(['/v1/models/mdl_1/cancel', '/v1/models'])
  expect(store.state.model?.info.id).toBe('mdl_2')
})

test('a model behind the live tree stays, and so does one that was canceled', async () => {
  const { calls, store, taken } = begin()
  store.set({ model: grownTree(), shows: 'live', liveTree: grown() })
  taken.take('foliage', 'needles')
  store.set({ model: shownModel({ status: 'canceled' }), shows: 'model' })
  taken.take('foliage', 'palm')
  await settle()
  expect(sent(calls)).toEqual([])
})

test('what is so already changes nothing, unless the model that is shown was grown as something else', async () => {
  const { calls, store, taken } = begin()
  store.set({ model: grownTree({ foliage: 'leaves' }), shows: 'model' })
  store.set({ settings: { ...store.state.settings, foliage: 'leaves' } })
  expect(taken.take('foliage', 'leaves')).toBe(false)
  store.set({ settings: { ...store.state.settings, foliage: 'palm' } })
  expect(taken.take('foliage', 'palm')).toBe(true)
  await settle()
  expect(sent(calls)).toEqual(['/v1/models'])
})
