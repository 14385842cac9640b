import { expect, test } from 'vitest'
import { drawnTree, outline } from '../../../src/ui/start/drawnTree'

test('the tree of the illustration is always the same one', () => {
  expect(drawnTree()).toEqual(drawnTree())
})

test('every branch but the trunk begins where another one ends', () => {
  const { twigs } = drawnTree()
  const ends = new Set(twigs.map(({ to }) => to))
  expect(twigs.slice(1).every(({ from }) => ends.has(from))).toBe(true)
})

test('the crown’s line keeps around the leaves', () => {
  const tree = drawnTree()
  const numbers = outline(tree)
    .match(/-?\d+(\.\d+)?/g)!
    .map(Number)
  const across = (values: number[]) => [Math.min(...values), Math.max(...values)] as const
  const [left, right] = across(numbers.filter((_, index) => index % 2 === 0))
  const [top] = across(numbers.filter((_, index) => index % 2 === 1))
  const [first, last] = across(tree.leaves.map(({ at }) => at[0]))
  expect(left).toBeLessThan(first)
  expect(right).toBeGreaterThan(last)
  expect(top).toBeLessThan(Math.min(...tree.leaves.map(({ at }) => at[1])))
})
