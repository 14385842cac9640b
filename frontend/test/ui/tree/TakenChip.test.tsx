// @vitest-environment jsdom
import 'fake-indexeddb/auto'
import { act } from 'preact/test-utils'
import { afterEach, beforeEach, expect, test, vi } from 'vitest'
import type { Limits, Taken } from '../../../src/api/types'
import type { State } from '../../../src/state'
import { Studio } from '../../../src/studio/studio'
import { TakenChip } from '../../../src/ui/tree/TakenChip'
import { answer, CROWN, grown, photoSheets, shownModel, TAKEN, TRUNK } from '../../builders'
import { mount } from '../mount'

const KINDS = ['auto', 'leaves', 'needles', 'scales', 'palm', 'bare']
const FORMS = ['auto', 'round', 'spire']
const settings: Limits['settings'] = {
  foliage: { default: 'auto', meaning: '', names: KINDS },
  form: { default: 'auto', meaning: '', names: FORMS },
}
let studio: Studio
let host: HTMLElement

beforeEach(() => {
  HTMLElement.prototype.hidePopover = () => {}
  vi.stubGlobal('fetch', () => new Promise(() => {})) // what is traced is set below
  studio = new Studio()
  studio.store.set({ sheets: photoSheets() })
  studio.strokes.draw('crown', CROWN)
  studio.strokes.draw('branch', TRUNK)
  studio.store.set({ limits: { settings } as Limits, liveTree: grown() })
  host = mount(studio, <TakenChip />)
})

afterEach(() => vi.unstubAllGlobals())

function set(change: Partial<State>): void {
  void act(() => studio.store.set(change))
}

function take(taken: Partial<Taken> = {}): void {
  set({ traced: { of: studio.store.strokes, answer: { ...answer(), taken: { ...TAKEN, ...taken } } } })
}

const textOf = (element: Element) => element.textContent
const chip = () => host.querySelector<HTMLElement>('.taken')!
const openers = () => [...chip().querySelectorAll<HTMLElement>(':scope > .button')].map(words)
const words = (element: Element) => [...element.querySelectorAll(':scope > span')].map(textOf).join(', ')
const choices = (menu = 0) => [...chip().querySelectorAll('[role=radiogroup]')[menu]!.querySelectorAll('button')]

const checked = () =>
  choices()
    .filter(one => one.getAttribute('aria-checked') === 'true')
    .map(textOf)

function click(button: HTMLElement): void {
  void act(() => button.click())
}

test('before the trunk is traced there is no chip', () => {
  expect(chip().hidden).toBe(true)
  set({ traced: { of: studio.store.strokes, answer: answer() } })
  expect(chip().hidden).toBe(true)
})

test('it says what the tree is taken for and how sure that is', () => {
  take()
  expect([chip().hidden, openers()]).toEqual([false, ['Taken for: needles, fairly sure', 'Form: spire']])
  take({ sureness: 0.97 })
  expect(openers()[0]).toBe('Taken for: needles, very sure')
})

test('the choices are all kinds in plain words, and what the photo shows', () => {
  take()
  expect(choices().map(textOf)).toEqual([
    'As in the photo (needles)',
    'Leaves',
    'Needles',
    'Scales (cypress, juniper)',
    'Palm',
    'Bare',
  ])
  expect(checked()).toEqual(['As in the photo (needles)'])
  expect(choices(1).map(textOf)).toEqual(['As in the photo (spire)', 'Round', 'Spire (fir)'])
})

test('one click changes the kind, and another gives it back to the photo', () => {
  take()
  click(choices()[3]!)
  expect(studio.store.state.settings.foliage).toBe('scales')
  expect(studio.store.state.announcement).toBe('Scales (cypress, juniper). The tree grows again.')
  expect([openers()[0], checked()]).toEqual(['Chosen: scales', ['Scales (cypress, juniper)']])
  click(choices()[0]!)
  expect(studio.store.state.settings.foliage).toBe('auto')
  expect(openers()[0]).toBe('Taken for: needles, fairly sure')
})

test('the form is changed as the kind is', () => {
  take()
  click(choices(1)[1]!)
  expect(studio.store.state.settings).toMatchObject({ form: 'round', foliage: 'auto' })
  expect(openers()[1]).toBe('Form: round')
})

test('of a model that was grown as another kind the chip says that kind', () => {
  take()
  const info = { status: 'succeeded', settings: { foliage: 'leaves' } } as const
  set({ model: shownModel(info, { strokes: studio.store.strokes, glb: new ArrayBuffer(4) }), shows: 'model' })
  expect(openers()[0]).toBe('Chosen: leaves')
  set({ shows: 'live' })
  expect(openers()[0]).toBe('Taken for: needles, fairly sure')
})

test('a species that was chosen stands in place of the guess', () => {
  take()
  set({ settings: { ...studio.store.state.settings, species: 'oak' } })
  expect(openers()[0]).toBe('Species: oak')
  expect(textOf(choices()[0]!)).toBe('As the species (oak)')
})

test('where the photo leaves it open the kind is asked for, with all kinds in sight', () => {
  take({ ask: true, sureness: 0.4 })
  expect(chip().querySelector('p')!.textContent).toContain('What kind of tree is this?')
  expect(studio.store.state.announcement).toBe('What kind of tree is this?')
  expect(choices().map(textOf)).toEqual(['Leaves', 'Needles', 'Scales (cypress, juniper)', 'Palm', 'Bare'])
  expect(checked()).toEqual(['Needles'])
})

test('an answer puts the chip in place of the question, and the focus stays on it', () => {
  take({ ask: true })
  choices()[0]!.focus()
  click(choices()[0]!)
  expect(studio.store.state.settings.foliage).toBe('leaves')
  expect(openers()[0]).toBe('Chosen: leaves')
  expect(words(document.activeElement!)).toBe('Chosen: leaves')
})

test('growing the tree anyway ends the question, and the chip says that it is not sure', () => {
  take({ ask: true })
  set({ model: shownModel({ status: 'running' }), shows: 'model' })
  expect(openers()[0]).toBe('Taken for: needles, not sure')
})

test('a model that is shown is made again as the kind that was chosen', () => {
  const regrow = vi.spyOn(studio.grower, 'regrow').mockResolvedValue()
  take()
  set({ model: shownModel({ status: 'succeeded' }, { glb: new ArrayBuffer(4) }), shows: 'model' })
  click(choices()[1]!)
  expect(regrow).toHaveBeenCalledOnce()
})
