// @vitest-environment jsdom
import 'fake-indexeddb/auto'
import { render } from 'preact'
import { act } from 'preact/test-utils'
import { afterEach, beforeEach, expect, test, vi } from 'vitest'
import { Studio } from '../../../src/studio/studio'
import { StudioProvider, useStore } from '../../../src/ui/parts/useStore'
import { GalleryDialog } from '../../../src/ui/start/GalleryDialog'
import { model } from '../../builders'
import { type Call, service, settle } from '../../service'

let studio: Studio
let calls: Call[]
let models = [model({ status: 'failed' }), model({ id: 'mdl_2', name: '', status: 'canceled' })]

beforeEach(() => {
  HTMLDialogElement.prototype.showModal = function () {
    this.open = true
  }
  HTMLDialogElement.prototype.close = function () {
    this.open = false
    this.dispatchEvent(new Event('close'))
  }
  calls = service(({ method, path, body }) => {
    if (method === 'DELETE') return new Response(null, { status: 204 })
    if (method === 'PATCH') return Response.json({ ...models[0], name: body.name })
    if (path.endsWith('/restore')) return Response.json(models[0])
    return Response.json({ models, next: null })
  })
  studio = new Studio()
})
afterEach(() => {
  render(null, document.body)
  vi.unstubAllGlobals()
})

function Shown() {
  return useStore(({ dialog }) => dialog === 'gallery') && <GalleryDialog />
}

async function open(): Promise<void> {
  studio.store.set({ dialog: 'gallery' })
  act(() =>
    render(
      <StudioProvider value={studio}>
        <Shown />
      </StudioProvider>,
      document.body,
    ),
  )
  await settle()
}

/** Click, and let the page be drawn. */
const click = (target: Element | null) => act(() => (target as HTMLElement).click())

const cards = () => [...document.querySelectorAll<HTMLElement>('.card')]
const named = (label: string) => document.querySelector<HTMLElement>(`[aria-label="${label}"]`)!
const names = () => [...document.querySelectorAll('.card-name')].map(({ textContent }) => textContent)

test('models stand there by name, one without a name too, with what became of them', async () => {
  await open()
  expect(names()).toEqual(['Oak', 'Unnamed tree'])
  expect(cards().map(card => card.querySelector('.card-status')!.textContent)).toEqual(['Failed', 'Canceled'])
})

test('a deleted card gives its place to an undo that has the focus, and undo brings it back', async () => {
  await open()
  click(named('Delete Oak'))
  await settle()
  expect([document.activeElement!.textContent, names()]).toEqual(['Undo', ['Unnamed tree']])
  click(document.activeElement)
  await settle()
  expect([document.activeElement, names()]).toEqual([named('Open Oak'), ['Oak', 'Unnamed tree']])
})

test('a name is written in place: Enter keeps it, Escape does not and leaves the gallery open', async () => {
  await open()
  click(named('Rename Oak'))
  const press = (key: string) => {
    const event = new KeyboardEvent('keydown', { key, bubbles: true, cancelable: true })
    act(() => void document.activeElement!.dispatchEvent(event))
    return event
  }
  ;(document.activeElement as HTMLInputElement).value = 'Elm'
  expect(press('Escape').defaultPrevented).toBe(true)
  expect([names()[0], document.activeElement]).toEqual(['Oak', named('Rename Oak')])
  click(named('Rename Oak'))
  ;(document.activeElement as HTMLInputElement).value = ' Ash '
  press('Enter')
  await settle()
  expect([names()[0], calls.filter(({ method }) => method === 'PATCH')]).toEqual([
    'Ash',
    [{ method: 'PATCH', path: '/v1/models/mdl_1', body: { name: 'Ash' } }],
  ])
})

test('opening a model closes the gallery', async () => {
  const opened = vi.spyOn(studio.opener, 'openModel').mockResolvedValue()
  await open()
  click(named('Open Oak'))
  expect([opened.mock.calls, document.querySelector('dialog')]).toEqual([[['mdl_1']], null])
})

test('without models it says how to get some', async () => {
  models = []
  await open()
  expect(document.querySelector<HTMLElement>('.gallery-empty')!.hidden).toBe(false)
})

test('the gallery is searched, and narrowed to a tag or to somebody', async () => {
  const maker = { id: 'usr_2', name: 'Ben' }
  models = [model({ status: 'failed', tags: ['park'], maker })]
  await open()
  const asked = () => calls.at(-1)!.path
  click(document.querySelector('.card-tag'))
  await act(settle)
  expect(asked()).toContain('tag=park')
  click(document.querySelector('.card-maker'))
  await act(settle)
  expect(asked()).toContain('maker=usr_2')
  const field = document.querySelector<HTMLInputElement>('input[type=search]')!
  field.value = 'oak '
  field.dispatchEvent(new Event('input', { bubbles: true }))
  await vi.waitFor(() => expect(asked()).toContain('q=oak'))
})
