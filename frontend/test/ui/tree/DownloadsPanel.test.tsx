// @vitest-environment jsdom
import 'fake-indexeddb/auto'
import { act } from 'preact/test-utils'
import { beforeEach, expect, test, vi } from 'vitest'
import { Studio } from '../../../src/studio/studio'
import { DownloadsPanel } from '../../../src/ui/tree/DownloadsPanel'
import { shownModel } from '../../builders'
import { settle } from '../../service'
import { mount } from '../mount'

let studio: Studio
let panel: HTMLElement
let picture: () => Promise<Blob>

beforeEach(() => {
  studio = new Studio()
  studio.store.set({ model: shownModel({ status: 'succeeded' }, { glb: new ArrayBuffer(4) }) })
  picture = async () => new Blob()
  panel = mount(studio, <DownloadsPanel picture={() => picture()} moreFormats={() => {}} />)
})

async function click(label: string): Promise<void> {
  const found = [...panel.querySelectorAll('button')].find(({ textContent }) => textContent?.startsWith(label))!
  await act(async () => {
    found.click()
    await settle()
  })
}

test('a copied link is announced and leads to the model', async () => {
  const writeText = vi.fn(async () => {})
  vi.stubGlobal('navigator', { clipboard: { writeText } })
  await click('Copy link')
  expect(writeText).toHaveBeenCalledWith(`${location.origin}/#mdl_1`)
  expect([studio.store.state.announcement, panel.querySelector<HTMLElement>('.link-refused')!.hidden]).toEqual([
    'Copied',
    true,
  ])
})

test('a link that may not be copied is shown and selected, until another model is shown', async () => {
  vi.stubGlobal('navigator', { clipboard: { writeText: () => Promise.reject(new Error('no')) } })
  await click('Copy link')
  const field = panel.querySelector<HTMLInputElement>('.link-field')!
  expect(field.parentElement!.hidden).toBe(false)
  expect(document.activeElement).toBe(field)
  expect(field.value.slice(field.selectionStart!, field.selectionEnd!)).toBe(`${location.origin}/#mdl_1`)
  await act(() => studio.store.set({ model: shownModel({ id: 'mdl_2' }) }))
  expect(panel.querySelector<HTMLElement>('.link-refused')!.hidden).toBe(true)
})

test('a picture that cannot be drawn is told at the preview', async () => {
  picture = () => Promise.reject(new Error('no WebGL'))
  await click('Picture')
  expect(studio.store.state.faults.preview?.text).toContain('picture could not be saved')
})
