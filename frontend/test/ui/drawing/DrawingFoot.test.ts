// @vitest-environment jsdom
import { expect, test } from 'vitest'
import { BRUSHES, nextBrush } from '../../../src/ui/drawing/DrawingFoot'

test('brushes go from the pencil to the broadest, and no further', () => {
  const widths = BRUSHES.map(([width]) => width)
  expect(nextBrush(null, -1)).toBeNull()
  expect(nextBrush(null, 1)).toBe(widths[1])
  expect(nextBrush(widths[3]!, 1)).toBe(widths[3])
  expect(nextBrush(widths[2]!, -1)).toBe(widths[1])
})
