import { expect, test } from 'vitest'
import type { Taken } from '../src/api/types'
import { EMPTY, type State } from '../src/state'
import { asksForKind, shownTaken, takenIn, traitOf } from '../src/taken'
import { answer, grown, shownModel, TAKEN } from './builders'

function state(changes: Partial<State> = {}): State {
  const traced = { of: EMPTY.history.present, answer: { ...answer(), taken: TAKEN } }
  return { ...EMPTY, traced, liveTree: grown(), ...changes }
}

function chosen(changes: Partial<State['settings']>): Partial<State> {
  return { settings: { ...EMPTY.settings, ...changes } }
}

/** A model that is shown, made by these settings. */
function made(settings: Partial<State['settings']>, taken: Taken | null = null): Partial<State> {
  const info = { status: 'succeeded', settings, taken } as const
  return { shows: 'model', model: shownModel(info, { strokes: EMPTY.history.present, glb: new ArrayBuffer(4) }) }
}

test('a tree is what its photo was taken for, until the settings say otherwise', () => {
  expect(traitOf(state(), 'foliage')).toEqual({ name: 'needles', from: 'photo' })
  expect(traitOf(state(chosen({ foliage: 'palm' })), 'foliage')).toEqual({ name: 'palm', from: 'settings' })
  expect(traitOf(state(chosen({ form: 'vase' })), 'form')).toEqual({ name: 'vase', from: 'settings' })
})

test('a species brings its own foliage, but a kind that was chosen goes before it', () => {
  expect(traitOf(state(chosen({ species: 'oak' })), 'foliage')).toEqual({ name: 'oak', from: 'species' })
  expect(traitOf(state(chosen({ species: 'oak' })), 'form')).toEqual({ name: 'spire', from: 'photo' })
  const both = chosen({ species: 'oak', foliage: 'bare' })
  expect(traitOf(state(both), 'foliage')).toEqual({ name: 'bare', from: 'settings' })
})

test('nothing is known of a tree before its trunk is traced, and of one that is sketched', () => {
  expect(traitOf(EMPTY, 'foliage')).toBeNull()
  expect(traitOf(state({ traced: { of: EMPTY.history.present, answer: answer() } }), 'foliage')).toBeNull()
})

test('a model that is shown is what it was grown as, whatever has been chosen since', () => {
  const stale = state({ ...made({ foliage: 'leaves' }), ...chosen({ foliage: 'palm' }) })
  expect(traitOf(stale, 'foliage')).toEqual({ name: 'leaves', from: 'settings' })
  expect(traitOf({ ...stale, shows: 'live' }, 'foliage')).toEqual({ name: 'palm', from: 'settings' })
})

test('a model that is not there yet is not what is shown', () => {
  const waiting = state({ ...made({ foliage: 'leaves' }), ...chosen({ foliage: 'palm' }) })
  const model = { ...waiting.model!, glb: null }
  expect(traitOf({ ...waiting, model }, 'foliage')).toEqual({ name: 'palm', from: 'settings' })
})

test('a model of other strokes was taken for something of its own', () => {
  const same = state(made({}, { ...TAKEN, foliage: 'scales' }))
  expect(shownTaken(same)).toEqual(TAKEN)
  const other = { ...same, traced: { of: { ...EMPTY.history.present }, answer: same.traced!.answer } }
  expect(shownTaken(other)?.foliage).toBe('scales')
  expect(takenIn(other)).toEqual(TAKEN)
  expect(takenIn({ ...same, traced: null })?.foliage).toBe('scales')
})

test('the kind is asked for where the photo leaves it open, until it is chosen or a tree is grown', () => {
  const traced = { of: EMPTY.history.present, answer: { ...answer(), taken: { ...TAKEN, ask: true } } }
  const asks = (changes: Partial<State>) => asksForKind(state({ traced, ...changes }))
  expect(asks({})).toBe(true)
  expect(asksForKind(state())).toBe(false)
  expect(asks(chosen({ foliage: 'needles' }))).toBe(false)
  expect(asks(chosen({ species: 'oak' }))).toBe(false)
  expect(asks({ asking: true })).toBe(false)
  expect(asks({ model: shownModel() })).toBe(false)
})
