import { expect, test } from 'vitest'
import { ago } from '../../../src/ui/start/when'

const NOW = Date.UTC(2026, 5, 15, 12)

test.each([
  [20, 'just now'],
  [60, '1 minute ago'],
  [3 * 3600 + 5, '3 hours ago'],
  [86400, 'yesterday'],
  [16 * 86400, '2 weeks ago'],
  [60 * 86400, 'Apr 16, 2026'],
])('%d seconds ago is %s', (seconds, said) => {
  expect(ago(NOW - seconds * 1000, NOW)).toBe(said)
})
