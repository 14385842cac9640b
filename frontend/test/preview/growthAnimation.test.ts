import { afterEach, beforeEach, expect, it, vi } from 'vitest'
import { GrowthAnimation } from '../../src/preview/growthAnimation'

beforeEach(() => void vi.useFakeTimers())
afterEach(() => void vi.useRealTimers())

it('shows the share of its time that has passed, and ends fully grown', async () => {
  const shares: number[] = []
  const growth = new GrowthAnimation(share => shares.push(share))
  const grown = growth.start(2)
  expect([growth.step(0.5), growth.step(0.5), growth.step(1.5), growth.step(1)]).toEqual([true, true, false, false])
  await grown
  expect(shares).toEqual([0, 0.25, 0.5, 1])
})

it('ends at once when it is stopped', async () => {
  const shares: number[] = []
  const growth = new GrowthAnimation(share => shares.push(share))
  const grown = growth.start(2)
  growth.stop()
  await grown
  expect([shares.at(-1), growth.running]).toEqual([1, false])
})

it('ends though no frame ever comes', async () => {
  const show = vi.fn()
  const grown = new GrowthAnimation(show).start(2)
  vi.advanceTimersByTime(10_000)
  await grown
  expect(show).toHaveBeenLastCalledWith(1)
})

it('ends one growth when another starts', async () => {
  const growth = new GrowthAnimation(() => {})
  const first = growth.start(2)
  growth.start(2)
  await first
  expect(growth.running).toBe(true)
})
