import 'fake-indexeddb/auto'
import { IDBFactory } from 'fake-indexeddb'
import { beforeEach, expect, test, vi } from 'vitest'
import { Store } from '../../src/state'
import { DraftStore } from '../../src/studio/draftStore'
import { StrokeActions } from '../../src/studio/strokeActions'
import { CROWN, photo, photoSheets, TRUNK } from '../builders'

beforeEach(() => {
  globalThis.indexedDB = new IDBFactory()
})

function begin() {
  const store = new Store()
  const drafts = new DraftStore(store)
  drafts.begin(null)
  return { store, drafts, strokes: new StrokeActions(store) }
}

/** A saved draft with a crown and a trunk. */
async function kept() {
  const { store, drafts, strokes } = begin()
  store.set({ sheets: photoSheets(), name: 'Oak' })
  strokes.draw('crown', CROWN)
  strokes.draw('branch', TRUNK)
  await vi.waitFor(async () => expect((await drafts.find(drafts.id!))?.draft.history.past).toHaveLength(2))
  return { store, drafts, strokes }
}

test('a drawing is saved with its photo and its undo history', async () => {
  const { store, drafts } = await kept()
  const found = (await new DraftStore(new Store()).find(drafts.id!))!
  expect(found.draft).toMatchObject({ name: 'Oak', history: store.state.history, photo: { id: 'pho_1' } })
  expect(await found.photo?.text()).toBe('a photo')
})

test('deleting and undoing are saved, too', async () => {
  const { drafts, strokes } = await kept()
  strokes.clear()
  strokes.undo()
  strokes.undo()
  await vi.waitFor(async () => {
    const { draft } = (await drafts.find(drafts.id!))!
    expect([draft.history.present.branches.length, draft.history.future.length]).toEqual([0, 2])
  })
})

test('the latest drawing is listed first, and those without a stroke are not', async () => {
  const { store, drafts, strokes } = await kept()
  const first = drafts.id
  drafts.begin(null)
  store.set({
    sheets: photoSheets(photo({ id: 'pho_2', file: new Blob(['another']) })),
    history: new Store().state.history,
  })
  await vi.waitFor(async () => expect(await drafts.find(drafts.id!)).not.toBeNull())
  expect((await drafts.list()).map(draft => draft.id)).toEqual([first])
  strokes.draw('crown', CROWN)
  await vi.waitFor(async () => expect((await drafts.list()).map(draft => draft.id)).toEqual([drafts.id, first]))
})

test('no more than twelve drafts are kept', async () => {
  const { store, drafts } = await kept()
  const first = drafts.id!
  for (let i = 0; i < 13; i++) {
    drafts.begin(null)
    store.set({ sheets: photoSheets(photo({ file: new Blob([`photo ${i}`]) })) })
    await vi.waitFor(async () => expect(await drafts.find(drafts.id!)).not.toBeNull())
  }
  expect(await drafts.list()).toHaveLength(12)
  expect(await drafts.find(first)).toBeNull()
})

test('a deleted drawing is gone', async () => {
  const { drafts } = await kept()
  await drafts.remove(drafts.id!)
  expect(await drafts.find(drafts.id!)).toBeNull()
})

test('the state tells that a browser cannot save', async () => {
  const store = new Store()
  new DraftStore(store, Promise.reject(new DOMException('private', 'InvalidStateError')))
  await vi.waitFor(() => expect(store.state.kept).toBe(false))
})

test('an own picture of a leaf is saved, removed and restored with its draft', async () => {
  const { store, drafts } = await kept()
  const id = drafts.id!
  store.set({ leaf: new Blob(['leaf']) })
  await vi.waitFor(async () => expect(await (await drafts.find(id))!.leaf?.text()).toBe('leaf'))
  const found = (await drafts.find(id))!
  await drafts.remove(id)
  await drafts.restore(found)
  expect(await (await drafts.find(id))!.leaf?.text()).toBe('leaf')
  store.set({ leaf: null })
  await vi.waitFor(async () => expect((await drafts.find(id))!.leaf).toBeNull())
})
