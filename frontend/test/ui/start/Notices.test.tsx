// @vitest-environment jsdom
import 'fake-indexeddb/auto'
import { render } from 'preact'
import { act } from 'preact/test-utils'
import { afterEach, beforeEach, expect, test, vi } from 'vitest'
import type { Notice } from '../../../src/state'
import { Studio } from '../../../src/studio/studio'
import { StudioProvider } from '../../../src/ui/parts/useStore'
import { Notices } from '../../../src/ui/start/Notices'
import { warnUnkept, warnUnopened } from '../../../src/ui/start/warnings'
import { photoSheets } from '../../builders'

const LONG_MS = 20_000
let studio: Studio

beforeEach(() => {
  vi.useFakeTimers({ toFake: ['setTimeout', 'clearTimeout'] })
  studio = new Studio()
  act(() =>
    render(
      <StudioProvider value={studio}>
        <Notices />
      </StudioProvider>,
      document.body,
    ),
  )
})
afterEach(() => {
  render(null, document.body)
  vi.useRealTimers()
})

const shown = () => [...document.querySelectorAll('.notice')]
const said = () => shown().map(notice => notice.querySelector('p')!.textContent)
const notify = (notice: Notice) => act(() => void studio.store.notify(notice))
const wait = () => act(() => void vi.advanceTimersByTime(LONG_MS))
const send = (name: string) => act(() => void shown()[0]!.dispatchEvent(new Event(name)))

test('a notice goes by itself and tells so, one that stays does not', () => {
  const gone = vi.fn()
  notify({ text: 'Saved.', gone })
  notify({ text: 'This browser saves nothing.', stays: true })
  expect(said()).toEqual(['Saved.', 'This browser saves nothing.'])
  wait()
  expect([said(), gone.mock.calls.length]).toEqual([['This browser saves nothing.'], 1])
})

test('a notice that is pointed at stays until the pointer has left it', () => {
  notify({ text: 'Saved.' })
  send('pointerenter')
  wait()
  expect(said()).toEqual(['Saved.'])
  send('pointerleave')
  wait()
  expect(said()).toEqual([])
})

test('its button does what it offers and closes it, the cross only closes it', () => {
  const run = vi.fn()
  const [undo, cross] = ['.notice-action', '.notice .square']
  const click = (button: string) => act(() => document.querySelector<HTMLElement>(button)!.click())
  notify({ text: 'Deleted.', action: { label: 'Undo', run } })
  click(undo)
  expect([said(), run.mock.calls.length]).toEqual([[], 1])
  notify({ text: 'Deleted.', action: { label: 'Undo', run } })
  click(cross)
  expect([said(), run.mock.calls.length]).toEqual([[], 1])
})

test('it is said as long as the browser cannot keep the drawing that is open', () => {
  warnUnkept(studio)
  act(() => studio.store.set({ kept: false }))
  expect(said()).toEqual([])
  act(() => studio.store.set({ sheets: photoSheets() }))
  wait()
  expect(said()).toHaveLength(1)
  act(() => studio.store.set({ kept: true }))
  expect(said()).toEqual([])
})

test('a file that cannot be opened is a notice while a drawing is open', () => {
  warnUnopened(studio)
  act(() => studio.store.fault('photo', { text: 'This is not a photo.' }))
  expect(said()).toEqual([])
  act(() => studio.store.set({ sheets: photoSheets() }))
  expect(said()).toEqual(['This is not a photo.'])
  wait()
  expect([said(), studio.store.state.faults.photo]).toEqual([[], undefined])
})
