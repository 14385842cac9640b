import 'fake-indexeddb/auto'
import { IDBFactory } from 'fake-indexeddb'
import { beforeEach, expect, test, vi } from 'vitest'
import { Store } from '../../src/state'
import { Keeper } from '../../src/studio/draftStore'
import { Sketchbook } from '../../src/studio/strokeActions'
import { CROWN, photo, TRUNK } from '../builders'

beforeEach(() => {
  globalThis.indexedDB = new IDBFactory()
})

function begin() {
  const store = new Store()
  const keeper = new Keeper(store)
  keeper.begin(null)
  return { store, keeper, sketchbook: new Sketchbook(store) }
}

/** A drawing of a crown and a trunk, as kept. */
async function kept() {
  const { store, keeper, sketchbook } = begin()
  store.set({ photo: photo(), name: 'Oak' })
  sketchbook.draw('crown', CROWN)
  sketchbook.draw('branch', TRUNK)
  await vi.waitFor(async () => expect((await keeper.find(keeper.id!))?.draft.history.past).toHaveLength(2))
  return { store, keeper, sketchbook }
}

test('a drawing is kept with its photo and its undo history', async () => {
  const { store, keeper } = await kept()
  const found = (await new Keeper(new Store()).find(keeper.id!))!
  expect(found.draft).toMatchObject({ name: 'Oak', history: store.state.history, photo: { id: 'pho_1' } })
  expect(await found.photo?.text()).toBe('a photo')
})

test('what is deleted or undone is kept, too', async () => {
  const { keeper, sketchbook } = await kept()
  sketchbook.clear()
  sketchbook.undo()
  sketchbook.undo()
  await vi.waitFor(async () => {
    const { draft } = (await keeper.find(keeper.id!))!
    expect([draft.history.present.branches.length, draft.history.future.length]).toEqual([0, 2])
  })
})

test('the latest drawing is listed first, and those without a stroke are not', async () => {
  const { store, keeper, sketchbook } = await kept()
  const first = keeper.id
  keeper.begin(null)
  store.set({ photo: photo({ id: 'pho_2', file: new Blob(['another']) }), history: new Store().state.history })
  await vi.waitFor(async () => expect(await keeper.find(keeper.id!)).not.toBeNull())
  expect((await keeper.list()).map(draft => draft.id)).toEqual([first])
  sketchbook.draw('crown', CROWN)
  await vi.waitFor(async () => expect((await keeper.list()).map(draft => draft.id)).toEqual([keeper.id, first]))
})

test('no more than a dozen are kept', async () => {
  const { store, keeper } = await kept()
  const first = keeper.id!
  for (let i = 0; i < 13; i++) {
    keeper.begin(null)
    store.set({ photo: photo({ file: new Blob([`photo ${i}`]) }) })
    await vi.waitFor(async () => expect(await keeper.find(keeper.id!)).not.toBeNull())
  }
  expect(await keeper.list()).toHaveLength(12)
  expect(await keeper.find(first)).toBeNull()
})

test('a deleted drawing is gone', async () => {
  const { keeper } = await kept()
  await keeper.remove(keeper.id!)
  expect(await keeper.find(keeper.id!)).toBeNull()
})

test('a browser that keeps nothing is noticed', async () => {
  const store = new Store()
  new Keeper(store, Promise.reject(new DOMException('private', 'InvalidStateError')))
  await vi.waitFor(() => expect(store.state.kept).toBe(false))
})

test('a leaf of one’s own is kept with the drawing, goes with it, and comes back with it', async () => {
  const { store, keeper } = await kept()
  const id = keeper.id!
  store.set({ leaf: new Blob(['leaf']) })
  await vi.waitFor(async () => expect(await (await keeper.find(id))!.leaf?.text()).toBe('leaf'))
  const found = (await keeper.find(id))!
  await keeper.remove(id)
  await keeper.restore(found)
  expect(await (await keeper.find(id))!.leaf?.text()).toBe('leaf')
  store.set({ leaf: null })
  await vi.waitFor(async () => expect((await keeper.find(id))!.leaf).toBeNull())
})
