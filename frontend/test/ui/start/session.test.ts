// @vitest-environment jsdom
import 'fake-indexeddb/auto'
import { afterEach, expect, test, vi } from 'vitest'
import type { Draft } from '../../../src/studio/draftStore'
import { Studio } from '../../../src/studio/studio'
import { followSession, hasSession, resume } from '../../../src/ui/start/session'
import { photoSheets, shownModel } from '../../builders'

const MODEL = `mdl_${'a'.repeat(24)}`

function studioWith(drafts: readonly { id: string; model?: string }[]) {
  const studio = new Studio()
  vi.spyOn(studio.drafts, 'list').mockResolvedValue(drafts as unknown as Draft[])
  vi.spyOn(studio.drafts, 'find').mockImplementation(async id => {
    const draft = drafts.find(one => one.id === id) as unknown as Draft | undefined
    return draft ? { draft, photo: new Blob(), side: null, leaf: null, fruit: null } : null
  })
  const openDraft = vi.spyOn(studio.opener, 'openDraft').mockResolvedValue()
  const openModel = vi.spyOn(studio.opener, 'openModel').mockResolvedValue()
  return { studio, openDraft, openModel }
}

afterEach(() => {
  sessionStorage.clear()
  history.replaceState(null, '', '/')
})

test('a fresh tab opens nothing', async () => {
  const { studio, openDraft, openModel } = studioWith([{ id: 'one' }])
  expect(hasSession()).toBe(false)
  await resume(studio)
  expect(openDraft).not.toHaveBeenCalled()
  expect(openModel).not.toHaveBeenCalled()
})

test('a reload opens the drawing of this tab', async () => {
  sessionStorage.setItem('draft', 'two')
  const { studio, openDraft } = studioWith([{ id: 'one' }, { id: 'two' }])
  expect(hasSession()).toBe(true)
  await resume(studio)
  expect(openDraft).toHaveBeenCalledWith('two')
})

test('a drawing that is no longer kept is not asked for', async () => {
  sessionStorage.setItem('draft', 'gone')
  const { studio, openDraft } = studioWith([])
  await resume(studio)
  expect(openDraft).not.toHaveBeenCalled()
})

test('a link to a model opens the model', async () => {
  history.replaceState(null, '', `#${MODEL}`)
  const { studio, openModel } = studioWith([{ id: 'one' }])
  expect(hasSession()).toBe(true)
  await resume(studio)
  expect(openModel).toHaveBeenCalledWith(MODEL)
})

test('a link to a model opens the drawing whose model it is, this tab’s before a later one', async () => {
  history.replaceState(null, '', `#${MODEL}`)
  sessionStorage.setItem('draft', 'mine')
  const { studio, openDraft, openModel } = studioWith([
    { id: 'later', model: MODEL },
    { id: 'mine', model: MODEL },
  ])
  await resume(studio)
  expect(openDraft).toHaveBeenCalledWith('mine')
  expect(openModel).not.toHaveBeenCalled()
})

test('what is in the address and is no model is left alone', async () => {
  history.replaceState(null, '', '#mdl_xyz')
  const { studio, openModel } = studioWith([])
  await resume(studio)
  expect(openModel).not.toHaveBeenCalled()
})

test('address and memory follow what is open', async () => {
  const { studio } = studioWith([])
  followSession(studio)
  studio.drafts.begin('mine')
  studio.store.set({ sheets: photoSheets(), model: shownModel({ id: MODEL }) })
  expect(location.hash).toBe(`#${MODEL}`)
  expect(sessionStorage.getItem('draft')).toBe('mine')
  history.replaceState(null, '', '#mdl_000000000000000000000000')
  dispatchEvent(new Event('hashchange'))
  await vi.waitFor(() => expect(location.hash).toBe(`#${MODEL}`)) // no tree was opened by that address
  studio.store.set({ sheets: null, model: null })
  expect(location.hash).toBe('')
  expect(sessionStorage.getItem('draft')).toBeNull()
})
