// @vitest-environment jsdom
import 'fake-indexeddb/auto'
import { beforeEach, expect, test } from 'vitest'
import type { Limits } from '../../src/state'
import { Studio } from '../../src/studio/studio'
import { settingsPanel } from '../../src/ui/settings'

const settings: Limits['settings'] = {
  height: { default: 12, meaning: 'metres', min: 0.1, max: 150, whole: false },
  iterations: { default: 300, meaning: 'rounds of growth', min: 0, max: 2000, whole: true },
  foliage: { default: 'auto', meaning: 'what the twigs bear', names: ['auto', 'leaves', 'moss'] },
  wind_speed: { default: 0, meaning: 'how hard it blows', min: 0, max: 1, whole: false },
}
let studio: Studio
let panel: HTMLElement

beforeEach(() => {
  studio = new Studio()
  panel = settingsPanel(studio)
  document.body.replaceChildren(panel)
  studio.store.set({ limits: { settings } as Limits })
})

function field<T extends HTMLInputElement | HTMLSelectElement>(name: string): T {
  return panel.querySelector<T>(`#setting-${name}`)!
}

function write(name: string, value: string): void {
  field(name).value = value
  field(name).dispatchEvent(new Event('input'))
  field(name).dispatchEvent(new Event('change'))
}

const said = (name: string) => panel.querySelector(`#setting-${name}-wrong`)!.textContent
const labelOf = (name: string) => field(name).labels?.[0]?.textContent

test('every setting that the service takes has a labelled field, and so has the seed', () => {
  expect([...Object.keys(settings), 'seed'].map(labelOf)).toEqual(['Height', 'Growth', 'Foliage', 'Wind speed', 'Seed'])
})

test('a setting that the page does not know is explained in the words of the service, and can be chosen', () => {
  expect(panel.querySelector('#setting-wind_speed-why')!.textContent).toBe('how hard it blows')
  write('wind_speed', '0.5')
  expect(studio.store.state.settings).toMatchObject({ wind_speed: 0.5 })
  expect([...field<HTMLSelectElement>('foliage').options].map(({ text }) => text)).toEqual([
    'As in the photo',
    'Leaves',
    'moss',
  ])
})

test('what a setting does not take is said beside it and not chosen', () => {
  write('height', '25')
  write('height', '900')
  expect(said('height')).toBe('Give a number from 0.1 to 150.')
  expect(field('height').getAttribute('aria-invalid')).toBe('true')
  expect(studio.store.state.settings.height).toBe(25)
  write('iterations', '2.5')
  expect(said('iterations')).toBe('Give a whole number from 0 to 2000.')
})

test('half a number is no fault yet', () => {
  field('height').value = '0'
  field('height').dispatchEvent(new Event('input'))
  expect(said('height')).toBe('')
})

test('the slider and the field show the same', () => {
  const slider = field('iterations').parentElement!.querySelector<HTMLInputElement>('[type=range]')!
  slider.value = '500'
  slider.dispatchEvent(new Event('input'))
  expect([studio.store.state.settings.iterations, field('iterations').value]).toEqual([1000, '1000'])
})

test('reset gives the defaults of the service', () => {
  write('height', '25')
  write('height', '900')
  panel.querySelector<HTMLButtonElement>('.settings-foot button')!.click()
  expect(studio.store.state.settings).toMatchObject({ height: 12, iterations: 300, foliage: 'auto', wind_speed: 0 })
  expect([field('height').value, said('height')]).toEqual(['12', ''])
})

test('the seed is a whole number from 0', () => {
  write('seed', '-1')
  expect([studio.store.state.seed, said('seed')]).toEqual([
    0,
    `Give a whole number from 0 to ${Number.MAX_SAFE_INTEGER}.`,
  ])
  write('seed', '42')
  expect([studio.store.state.seed, said('seed')]).toEqual([42, ''])
})
