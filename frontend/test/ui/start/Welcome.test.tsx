// @vitest-environment jsdom
import 'fake-indexeddb/auto'
import { render } from 'preact'
import { act } from 'preact/test-utils'
import { afterEach, beforeEach, expect, test, vi } from 'vitest'
import { begin } from '../../../src/history'
import { paper } from '../../../src/sheets'
import { NO_STROKES, withStroke } from '../../../src/strokes'
import { Studio } from '../../../src/studio/studio'
import { text } from '../../../src/text'
import { StudioProvider } from '../../../src/ui/parts/useStore'
import { Welcome } from '../../../src/ui/start/Welcome'
import { sketchAnswer, sketchSheets, TRUNK } from '../../builders'
import { service, settle } from '../../service'

let studio: Studio
let models: unknown[] = []

beforeEach(() => {
  service(({ path }) => {
    if (path.endsWith('/trace')) return Response.json(sketchAnswer())
    return Response.json(path.startsWith('/v1/models') ? { models, next: null } : {})
  })
  vi.stubGlobal('matchMedia', () => ({ matches: true }))
  studio = new Studio()
})
afterEach(() => {
  render(null, document.body)
  vi.unstubAllGlobals()
})

async function open(): Promise<void> {
  act(() =>
    render(
      <StudioProvider value={studio}>
        <Welcome late={false} />
      </StudioProvider>,
      document.body,
    ),
  )
  await settle()
}

/** Wait until something holds, on a busy machine too. */
const until = (holds: () => boolean | Promise<boolean>) => vi.waitUntil(holds, { timeout: 4000 })
const names = () => [...document.querySelectorAll('.picks.small .pick-name')].map(({ textContent }) => textContent)
const section = (name: string) => document.querySelector<HTMLElement>(`[aria-labelledby=${name}]`)!

test('what is said is for fingers where there is no mouse', async () => {
  await open()
  expect(section('examples').textContent).toContain(text.welcome.examplesHint.touch)
})

test('a sentence about the two strokes is whole, and both are marked', async () => {
  await open()
  expect(document.querySelector('.lead')!.textContent).toContain('a loose line around the leaves and one up the trunk.')
  expect([...document.querySelectorAll('.lead span')].map(({ className }) => className)).toEqual([
    'lead-leaves',
    'lead-trunk',
  ])
})

test('a file that cannot be opened is told in its place', async () => {
  await open()
  const alert = document.querySelector<HTMLElement>('[role=alert]')!
  expect(alert.hidden).toBe(true)
  act(() => studio.store.fault('photo', { text: 'This is not a photo.' }))
  expect([alert.hidden, alert.textContent]).toEqual([false, 'This is not a photo.'])
})

test('the way to the gallery is there once a tree was grown', async () => {
  await open()
  expect(document.querySelector('.grown')!.closest('[hidden]')).not.toBeNull()
  render(null, document.body)
  models = [{ id: 'mdl_1', files: { 'preview.png': '/preview.png' } }]
  await open()
  const way = document.querySelector<HTMLElement>('.grown')!
  expect([way.closest('[hidden]'), way.querySelectorAll('img').length]).toEqual([null, 1])
  way.click()
  expect(studio.store.state.dialog).toBe('gallery')
})

test('a drawing that is deleted comes back by undo, and is shown after it was left', async () => {
  await open()
  expect([names(), section('drafts').hidden]).toEqual([[], true])
  studio.drafts.begin('mine')
  const history = begin(withStroke(NO_STROKES, 'branch', TRUNK))
  act(() => studio.store.set({ sheets: sketchSheets(paper()), name: 'Old oak', history }))
  await until(async () => (await studio.drafts.list()).length === 1)
  act(() => studio.opener.close())
  await until(() => names().length === 1)
  document.querySelector<HTMLElement>(`[aria-label="${text.welcome.deleteDraft('Old oak')}"]`)!.click()
  await until(() => names().length === 0)
  expect(studio.store.state.notices.map(notice => notice.text)).toEqual([text.welcome.draftDeleted('Old oak')])
  studio.store.state.notices[0]!.action!.run()
  await until(() => names().length === 1)
  expect(names()).toEqual(['Old oak'])
})
