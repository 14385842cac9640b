import { expect, test } from 'vitest'
import { outlineOf } from '../src/outlineOf'

/** A picture of rows of characters: # is dark, . is white, a space is transparent. */
function picture(...rows: string[]) {
  const pixels = [...rows.join('')].flatMap(one => {
    const grey = one === '#' ? 20 : 250
    return [grey, grey, grey, one === ' ' ? 0 : 255]
  })
  return { width: rows[0]!.length, height: rows.length, data: pixels }
}

test('the edge of a dark shape is followed once round', () => {
  const outline = outlineOf(picture('.....', '.###.', '.###.', '.###.', '.....'))!
  expect(outline).toHaveLength(8)
  expect(outline).toContainEqual([1.5, 1.5])
  expect(outline).toContainEqual([3.5, 3.5])
  expect(outline).not.toContainEqual([2.5, 2.5])
})

test('only the largest shape counts', () => {
  const outline = outlineOf(picture('#....', '.....', '..##.', '..##.'))!
  expect(outline.every(([x]) => x > 2)).toBe(true)
})

test('of a cut-out, what is opaque counts, however bright', () => {
  expect(outlineOf(picture('    ', ' .. ', ' .. ', '    '))).toHaveLength(4)
})

test('an empty picture has no outline', () => {
  expect(outlineOf(picture('...', '...'))).toBeNull()
  expect(outlineOf(picture('...', '.#.', '...'))).toBeNull()
})
