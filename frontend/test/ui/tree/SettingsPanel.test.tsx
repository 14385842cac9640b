// @vitest-environment jsdom
import 'fake-indexeddb/auto'
import { act } from 'preact/test-utils'
import { beforeEach, expect, test, vi } from 'vitest'
import type { Limits } from '../../../src/api/types'
import type { State } from '../../../src/state'
import { Studio } from '../../../src/studio/studio'
import { SettingsPanel, useSettingsView } from '../../../src/ui/tree/SettingsPanel'
import { CROWN, photoSheets, shownModel, TRUNK } from '../../builders'
import { mount } from '../mount'

const FILES = ['obj', 'usdz', 'moss']
const settings: Limits['settings'] = {
  height: { default: 12, meaning: 'metres', min: 0.1, max: 150, whole: false },
  iterations: { default: 300, meaning: 'rounds of growth', min: 0, max: 2000, whole: true },
  foliage: { default: 'auto', meaning: 'what grows on the twigs', names: ['auto', 'leaves', 'moss'] },
  wind_speed: { default: 0, meaning: 'how hard it blows', min: 0, max: 1, whole: false },
  species: { default: 'auto', meaning: 'shape of leaves', names: ['auto', 'oak'], group: 'leaves' },
  season: { default: 'photo', meaning: 'colour of leaves', names: ['photo', 'autumn'], group: 'leaves' },
  compress: { default: false, meaning: 'smaller', toggle: true, group: 'file' },
  files: { default: [], meaning: 'further files', names: FILES, several: true, group: 'file' },
}
let studio: Studio
let panel: HTMLElement

beforeEach(() => {
  studio = new Studio()
  studio.store.set({ limits: { settings } as Limits })
  panel = mount(studio, <Settings />)
})

function Settings() {
  return <SettingsPanel {...useSettingsView()} />
}

function set(change: Partial<State>): void {
  void act(() => studio.store.set(change))
}

function fire(target: EventTarget, event: Event): void {
  void act(() => void target.dispatchEvent(event))
}

function field<T extends HTMLInputElement | HTMLSelectElement>(name: string): T {
  return panel.querySelector<T>(`#setting-${name}`)!
}

function write(name: string, value: string): void {
  field(name).value = value
  fire(field(name), new Event('input'))
  fire(field(name), new Event('change'))
}

const said = (name: string) => panel.querySelector(`#setting-${name}-wrong`)!.textContent
const labelOf = (name: string) => field(name).labels?.[0]?.textContent

test('every setting that the service takes has a labelled field, and so has the seed', () => {
  const labels = ['height', 'iterations', 'foliage', 'wind_speed', 'season', 'compress', 'seed'].map(labelOf)
  expect(labels).toEqual(['Height', 'Growth', 'Foliage', 'Wind speed', 'Season', 'Compress the GLB', 'Seed'])
  expect(panel.querySelector('#setting-files legend')!.textContent).toBe('More formats')
})

test('a setting that the page does not know is explained in the words of the service, and can be chosen', () => {
  expect(panel.querySelector('#setting-wind_speed-why')!.textContent).toBe('how hard it blows')
  write('wind_speed', '0.5')
  expect(studio.store.state.settings).toMatchObject({ wind_speed: 0.5 })
  expect([...field<HTMLSelectElement>('foliage').options].map(({ text }) => text)).toEqual([
    'As in the photo',
    'Leaves',
    'Moss',
  ])
})

test('what a setting does not take is said beside it and not chosen', () => {
  write('height', '25')
  write('height', '900')
  expect(said('height')).toBe('Enter a number from 0.1 to 150.')
  expect(field('height').getAttribute('aria-invalid')).toBe('true')
  expect(studio.store.state.settings.height).toBe(25)
  write('iterations', '2.5')
  expect(said('iterations')).toBe('Enter a whole number from 0 to 2000.')
})

test('half a number is no fault yet', () => {
  field('height').value = '0'
  fire(field('height'), new Event('input'))
  expect(said('height')).toBe('')
})

test('the slider and the field show the same', () => {
  const slider = field('iterations').parentElement!.querySelector<HTMLInputElement>('[type=range]')!
  slider.value = '500'
  fire(slider, new Event('input'))
  expect([studio.store.state.settings.iterations, field('iterations').value]).toEqual([1000, '1000'])
})

test('reset gives the defaults of the service', () => {
  write('height', '25')
  write('height', '900')
  void act(() => panel.querySelector<HTMLButtonElement>('.settings-foot button')!.click())
  expect(studio.store.state.settings).toMatchObject({ height: 12, iterations: 300, foliage: 'auto', wind_speed: 0 })
  expect([field('height').value, said('height')]).toEqual(['12', ''])
})

test('what was written and not chosen is gone after a reset, and after the panel was closed', () => {
  const fill = () => {
    write('height', '900')
    expect([field('height').value, said('height')]).toEqual(['900', 'Enter a number from 0.1 to 150.'])
  }
  fill()
  void act(() => studio.store.set({ settings: { ...studio.store.state.settings } }))
  expect([field('height').value, said('height')]).toEqual(['10', ''])
  fill()
  fire(panel.querySelector('#settings')!, Object.assign(new Event('toggle'), { newState: 'closed' }))
  expect([field('height').value, said('height')]).toEqual(['10', ''])
})

test('the seed is a whole number from 0', () => {
  write('seed', '-1')
  expect([studio.store.state.seed, said('seed')]).toEqual([
    0,
    `Enter a whole number from 0 to ${Number.MAX_SAFE_INTEGER}.`,
  ])
  write('seed', '42')
  expect([studio.store.state.seed, said('seed')]).toEqual([42, ''])
})

test('settings lie in groups, of which one is shown', () => {
  const tabs = [...panel.querySelectorAll<HTMLElement>('[role=tab]')]
  expect(tabs.map(tab => tab.textContent)).toEqual(['Tree', 'Leaves', 'File'])
  const shown = () => [...panel.querySelectorAll<HTMLElement>('[role=tabpanel]')].filter(part => !part.hidden)
  expect(shown().map(part => part.contains(field('height')))).toEqual([true])
  fire(tabs[0]!, new KeyboardEvent('keydown', { key: 'ArrowRight', bubbles: true }))
  expect(shown().map(part => part.contains(field('season')))).toEqual([true])
  expect(document.activeElement).toBe(tabs[1])
  fire(tabs[1]!, new KeyboardEvent('keydown', { key: 'End', bubbles: true }))
  expect(document.activeElement).toBe(tabs[2])
})

test('a yes or no, and several names at once, can be chosen', () => {
  void act(() => field<HTMLInputElement>('compress').click())
  const boxes = [...panel.querySelectorAll<HTMLInputElement>('#setting-files input')]
  expect(boxes.map(box => box.labels![0]!.textContent)).toEqual(['Wavefront OBJ', 'USDZ (Apple)', 'Moss'])
  void act(() => boxes[1]!.click())
  void act(() => boxes[0]!.click())
  expect(studio.store.state.settings).toMatchObject({ compress: true, files: ['obj', 'usdz'] })
  void act(() => boxes[1]!.click())
  expect(studio.store.state.settings.files).toEqual(['obj'])
})

test('the height says that the measured line has taken its place', () => {
  void act(() => studio.strokes.draw('scale', TRUNK))
  void act(() => studio.strokes.measure(1.8))
  expect(panel.querySelector('#setting-height-note')!.textContent).toContain('1.8 m')
  expect(field<HTMLInputElement>('height').disabled).toBe(true)
  void act(() => studio.strokes.undo())
  void act(() => studio.strokes.undo())
  expect(panel.querySelector('#setting-height-note')!.textContent).toBe('')
  expect(field<HTMLInputElement>('height').disabled).toBe(false)
})

test('what only makes files of a grown tree says so', () => {
  const said = () => panel.querySelector('.settings-again')!.textContent
  set({ sheets: photoSheets() })
  void act(() => studio.strokes.draw('crown', CROWN))
  void act(() => studio.strokes.draw('branch', TRUNK))
  const info = { status: 'succeeded', settings: { ...studio.store.state.settings } } as const
  set({ model: shownModel(info, { strokes: studio.store.strokes, glb: new ArrayBuffer(4) }) })
  expect(said()).toBe('')
  void act(() => field<HTMLInputElement>('compress').click())
  expect(said()).toContain('The tree stays the same')
  write('height', '25')
  expect(said()).toBe('')
})

test('a leaf of one’s own is chosen, seen, refused with a reason, and removed', async () => {
  vi.stubGlobal('URL', Object.assign(URL, { createObjectURL: () => 'blob:leaf', revokeObjectURL: () => {} }))
  const leaf = new Blob(['leaf'])
  const buttons = () => [...panel.querySelectorAll<HTMLElement>('[aria-labelledby=setting-leaf] button')]
  const shown = () =>
    buttons()
      .filter(one => !one.hidden)
      .map(one => one.textContent)
  expect(shown()).toEqual(['Choose a picture'])
  set({ leaf })
  expect([shown(), panel.querySelector<HTMLImageElement>('.own-picture')!.hidden]).toEqual([
    ['Replace', 'Remove'],
    false,
  ])
  await act(() => studio.ownPictures.use(new File(['no'], 'leaf.png')))
  expect(panel.querySelector('[aria-labelledby=setting-leaf] .setting-wrong')!.textContent).toContain('not a PNG')
  expect(studio.store.state.leaf).toBe(leaf)
  void act(() => buttons()[1]!.click())
  expect([studio.store.state.leaf, shown()]).toEqual([null, ['Choose a picture']])
})
