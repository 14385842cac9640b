import { expect, test, vi } from 'vitest'
import { Store } from '../src/state'

test('who watches is told at once and whenever what it watches changes, not otherwise', () => {
  const store = new Store()
  const told = vi.fn()
  const end = store.watch(state => state.name, told)
  store.set({ name: 'Oak' })
  store.set({ seed: 4 })
  end()
  store.set({ name: 'Elm' })
  expect(told.mock.calls.flat()).toEqual(['', 'Oak'])
})

test('a fault stands in its place until it is taken away', () => {
  const store = new Store()
  store.fault('photo', { text: 'Too large.' })
  store.fault('grow', { text: 'No trunk.' })
  store.fault('photo', null)
  expect(store.state.faults).toEqual({ grow: { text: 'No trunk.' } })
})

test('taking away a fault that is not there tells nobody', () => {
  const store = new Store()
  const told = vi.fn()
  store.watch(state => state.faults, told)
  store.fault('photo', null)
  expect(told).toHaveBeenCalledTimes(1)
})

test('a sentence that is announced again changes the announcement, so that it is read again', () => {
  const store = new Store()
  const told = vi.fn()
  store.watch(state => state.announcement, told)
  for (let times = 0; times < 3; times++) store.announce('Undone.')
  expect(told.mock.calls.flat().map(said => said.trim())).toEqual(['', 'Undone.', 'Undone.', 'Undone.'])
})
