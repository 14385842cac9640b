import { expect, test, vi } from 'vitest'
import { Store } from '../src/state'

test('a watcher is called at once and whenever its value changes, not otherwise', () => {
  const store = new Store()
  const listener = vi.fn()
  const stop = store.watch(state => state.name, listener)
  store.set({ name: 'Oak' })
  store.set({ seed: 4 })
  stop()
  store.set({ name: 'Elm' })
  expect(listener.mock.calls.flat()).toEqual(['', 'Oak'])
})

test('a fault stays in its place until it is removed', () => {
  const store = new Store()
  store.fault('photo', { text: 'Too large.' })
  store.fault('grow', { text: 'No trunk.' })
  store.fault('photo', null)
  expect(store.state.faults).toEqual({ grow: { text: 'No trunk.' } })
})

test('removing a fault that is not there calls no watcher', () => {
  const store = new Store()
  const listener = vi.fn()
  store.watch(state => state.faults, listener)
  store.fault('photo', null)
  expect(listener).toHaveBeenCalledTimes(1)
})
