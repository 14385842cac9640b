import { afterEach, beforeEach, expect, it, vi } from 'vitest'
import { Ageing } from '../../src/preview/ageing'

beforeEach(() => void vi.useFakeTimers())
afterEach(() => void vi.useRealTimers())

it('shows the share of its time that has passed, and ends fully grown', async () => {
  const shares: number[] = []
  const ageing = new Ageing(share => shares.push(share))
  const grown = ageing.start(2)
  expect([ageing.step(0.5), ageing.step(0.5), ageing.step(1.5), ageing.step(1)]).toEqual([true, true, false, false])
  await grown
  expect(shares).toEqual([0, 0.25, 0.5, 1])
})

it('ends at once when it is stopped', async () => {
  const shares: number[] = []
  const ageing = new Ageing(share => shares.push(share))
  const grown = ageing.start(2)
  ageing.stop()
  await grown
  expect([shares.at(-1), ageing.running]).toEqual([1, false])
})

it('ends though no frame ever comes', async () => {
  const show = vi.fn()
  const grown = new Ageing(show).start(2)
  vi.advanceTimersByTime(10_000)
  await grown
  expect(show).toHaveBeenLastCalledWith(1)
})

it('ends one growth where another begins', async () => {
  const ageing = new Ageing(() => {})
  const first = ageing.start(2)
  ageing.start(2)
  await first
  expect(ageing.running).toBe(true)
})
