import { afterEach, expect, test, vi } from 'vitest'
import { Client } from '../../src/api/client'
import { Store } from '../../src/state'
import { Gallery } from '../../src/studio/gallery'
import { model, shownModel } from '../builders'
import { type Call, problem, service } from '../service'

afterEach(() => vi.unstubAllGlobals())

function serve({ method, path, body }: Call): Response {
  if (method === 'DELETE') return new Response(null, { status: 204 })
  if (method === 'PATCH') return Response.json(model({ status: 'succeeded', name: body.name }))
  if (path.endsWith('/restore')) return Response.json(model({ status: 'succeeded' }))
  const last = path.includes('cursor=7')
  return Response.json({ models: [model({ id: last ? 'mdl_2' : 'mdl_1' })], next: last ? null : '7' })
}

function begin() {
  const store = new Store()
  const grower = { stopFollowing: vi.fn() }
  return { store, grower, gallery: new Gallery(store, new Client(), grower) }
}

test('pages follow each other until there is no more', async () => {
  service(serve)
  const { gallery } = begin()
  expect((await gallery.more())?.map(({ id }) => id)).toEqual(['mdl_1'])
  expect(gallery.hasMore).toBe(true)
  expect((await gallery.more())?.map(({ id }) => id)).toEqual(['mdl_2'])
  expect(gallery.hasMore).toBe(false)
})

test('a page that cannot be read is a fault of the gallery until one can', async () => {
  let down = true
  service(call => (down ? problem(422, 'cursor_invalid', 'there is no such page') : serve(call)))
  const { store, gallery } = begin()
  expect(await gallery.more()).toBeNull()
  expect(store.state.faults.gallery?.text).toBe('There is no such page.')
  down = false
  expect(await gallery.more()).toHaveLength(1)
  expect(store.state.faults.gallery).toBeUndefined()
})

test('the shown model disappears when it is deleted, the strokes stay, and undo brings it back', async () => {
  service(serve)
  const { store, grower, gallery } = begin()
  const glb = new ArrayBuffer(4)
  const drawn = store.strokes
  store.set({ model: shownModel({ status: 'succeeded' }, { strokes: drawn, glb }), shows: 'model' })
  await gallery.remove('mdl_1')
  expect([store.state.model, store.strokes]).toEqual([null, drawn])
  expect(grower.stopFollowing).toHaveBeenCalledOnce()
  await gallery.restore('mdl_1')
  expect([store.state.model?.info.id, store.state.model?.glb, store.state.model?.strokes]).toEqual([
    'mdl_1',
    glb,
    drawn,
  ])
})

test('deleting another model leaves the shown one', async () => {
  service(serve)
  const { store, grower, gallery } = begin()
  store.set({ model: shownModel({ id: 'mdl_9' }) })
  await gallery.remove('mdl_1')
  expect(store.state.model?.info.id).toBe('mdl_9')
  expect(grower.stopFollowing).not.toHaveBeenCalled()
})

test('renaming the shown model renames the drawing', async () => {
  service(serve)
  const { store, gallery } = begin()
  store.set({ model: shownModel({ status: 'succeeded' }), name: 'Oak' })
  await gallery.rename('mdl_1', 'Old oak')
  expect([store.state.name, store.state.model?.info.name]).toEqual(['Old oak', 'Old oak'])
})
