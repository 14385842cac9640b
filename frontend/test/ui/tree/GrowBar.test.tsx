// @vitest-environment jsdom
import 'fake-indexeddb/auto'
import { act } from 'preact/test-utils'
import { beforeEach, expect, test, vi } from 'vitest'
import type { State } from '../../../src/state'
import { Studio } from '../../../src/studio/studio'
import { GrowBar } from '../../../src/ui/tree/GrowBar'
import { CROWN, photoSheets, shownModel, TRUNK } from '../../builders'
import { mount } from '../mount'

let studio: Studio
let bar: HTMLElement
let opened: string[]

beforeEach(() => {
  studio = new Studio()
  opened = []
  vi.spyOn(studio.client, 'trace').mockReturnValue(new Promise(() => {}))
  const settings = {
    ...{ panelRef: { current: null }, group: 'tree', choose: () => {} },
    open: (group: string) => opened.push(group),
  }
  bar = mount(studio, <GrowBar settings={settings} picture={async () => new Blob()} />)
})

function set(change: Partial<State>): void {
  void act(() => studio.store.set(change))
}

function draw(): void {
  set({ sheets: photoSheets(), name: 'Old oak' })
  void act(() => studio.strokes.draw('crown', CROWN))
  void act(() => studio.strokes.draw('branch', TRUNK))
}

function named(label: string): HTMLElement {
  return [...bar.querySelectorAll<HTMLElement>('.growth-status button')].find(
    ({ textContent }) => textContent === label,
  )!
}

const grow = () => bar.querySelector<HTMLButtonElement>('.grow')!
const words = () => bar.querySelector('.status-words')!.textContent
const progress = () => bar.querySelector<HTMLElement>('[role=progressbar]')!
const files = {
  'tree.glb': '/m/tree.glb',
  'preview.png': '/m/p.png',
  'tree.usdz': '/m/tree.usdz',
  project: '/m/project',
  'later.xyz': '/m/later',
}

test('Grow asks for nothing and says why until there is a trunk', () => {
  const asked = vi.spyOn(studio.grower, 'grow').mockResolvedValue()
  set({ sheets: photoSheets() })
  grow().click()
  expect([asked.mock.calls.length, grow().getAttribute('aria-disabled')]).toEqual([0, 'true'])
  expect(document.getElementById(grow().getAttribute('aria-describedby')!)!.textContent).toBe(words())
  draw()
  grow().click()
  expect([asked.mock.calls.length, grow().getAttribute('aria-disabled')]).toEqual([1, 'false'])
})

test('the bar shows how far a tree is, and no figure while it waits', () => {
  draw()
  set({ model: shownModel({ queue_position: 2 }) })
  expect([words(), progress().hidden, progress().hasAttribute('aria-valuenow')]).toEqual([
    '1 tree is ahead in the queue',
    false,
    false,
  ])
  set({ model: shownModel({ status: 'running', phase: 'leaf', progress: 0.427 }) })
  expect([words(), progress().getAttribute('aria-valuenow')]).toEqual(['Adding leaves', '42'])
  set({ online: false })
  expect(words()).toContain('connection is lost')
})

test('when Cancel vanishes under the focus, Grow has it', () => {
  draw()
  set({ model: shownModel({ status: 'running' }, { strokes: studio.store.strokes }) })
  named('Cancel').focus()
  set({ model: shownModel({ status: 'canceled' }) })
  expect([document.activeElement, named('Cancel').hidden]).toEqual([grow(), true])
  expect(grow().textContent).toBe('Grow again')
})

test('a failure says why and can be tried again', () => {
  const asked = vi.spyOn(studio.grower, 'grow').mockResolvedValue()
  draw()
  set({ model: shownModel({ status: 'failed' }, { strokes: studio.store.strokes }) })
  set({ faults: { grow: { text: 'The disk is full.' } } })
  expect([words(), named('Try again').hidden]).toEqual(['The disk is full.', false])
  named('Try again').click()
  expect(asked).toHaveBeenCalledOnce()
})

test('every file of a tree can be downloaded, those of a later service too, under the name of the drawing', () => {
  draw()
  set({ model: shownModel({ status: 'succeeded', name: 'Old oak', files }) })
  const links = [...bar.querySelectorAll<HTMLAnchorElement>('.panel a')]
  expect(links.map(link => [link.getAttribute('href'), link.download])).toEqual([
    ['/m/tree.glb', 'Old oak.glb'],
    ['/m/tree.usdz', 'Old oak.usdz'],
    ['/m/later', 'Old oak.later.xyz'],
  ])
})

test('without anything drawn there is nothing to download', () => {
  const opener = bar.querySelector<HTMLElement>('.downloads-opener')!
  expect(opener.hidden).toBe(true)
  draw()
  expect(opener.hidden).toBe(false)
})

test('downloads follow the tree that was chosen, and say which it is', () => {
  draw()
  const two = { ...files, 'tree.v2.glb': '/m/tree.v2.glb', 'tree.v2.usdz': '/m/tree.v2.usdz' }
  set({ model: shownModel({ status: 'succeeded', name: 'Old oak', files: two }, { variant: 2 }) })
  const links = [...bar.querySelectorAll<HTMLAnchorElement>('.tree-downloads a')]
  expect(links.map(link => link.download)).toEqual(['Old oak.v2.glb', 'Old oak.v2.usdz', 'Old oak.later.xyz'])
  expect(bar.querySelector('.tree-downloads h3')!.textContent).toBe('Tree 2 of 2')
  expect(bar.querySelector<HTMLAnchorElement>('.tree-link')!.getAttribute('href')).toBe('/m/tree.v2.glb')
})

test('More formats leads to the settings of files', () => {
  draw()
  set({ model: shownModel({ status: 'succeeded', files }) })
  bar.querySelector<HTMLElement>('.more-formats')!.click()
  expect(opened).toEqual(['file'])
})
