// @vitest-environment jsdom
import { type ComponentChild, render } from 'preact'
import { expect, test, vi } from 'vitest'
import { NO_STROKES, withSheet, withStroke } from '../../../src/strokes'
import { PairPicture, paperUrl, SheetPicture } from '../../../src/ui/parts/drawn'
import { CROWN, LIMB, TRUNK } from '../../builders'

const PAPER = { width: 900, height: 1200 }
const front = { ...withStroke(NO_STROKES, 'branch', TRUNK, 30), crown: CROWN }

function pictureOf(drawn: ComponentChild): Element {
  const host = document.createElement('div')
  render(drawn, host)
  return host.firstElementChild!
}

test('strokes are drawn in the sheet’s own pixels, a brush as wide as it is', () => {
  const picture = pictureOf(<SheetPicture size={PAPER} strokes={front} />)
  expect(picture.getAttribute('viewBox')).toBe('0 0 900 1200')
  const [crown, trunk] = [...picture.querySelectorAll('path')]
  expect(crown?.getAttribute('d')).toMatch(/z$/)
  expect([trunk?.getAttribute('d'), trunk?.getAttribute('stroke-width')]).toEqual(['M50 95L50 40', '30'])
})

test('two sides stand beside each other, as high as each other, with no more paper than they need', () => {
  const both = withSheet(front, 'side', withStroke(NO_STROKES, 'branch', LIMB))
  const pair = pictureOf(<PairPicture front={PAPER} strokes={both} side={{ ...PAPER }} />)
  const [left, top, width, height] = pair.getAttribute('viewBox')!.split(' ').map(Number)
  expect([left, top, height]).toEqual([20, 10, 85])
  expect(width).toBeGreaterThan(60 + 20)
  expect(pair.querySelectorAll('g path')).toHaveLength(1)
})

test('a picture on white paper is an SVG that needs no stylesheet', () => {
  const made = vi.fn((_: Blob) => 'blob:drawn')
  vi.stubGlobal('URL', { createObjectURL: made })
  expect(paperUrl(PAPER, front)).toBe('blob:drawn')
  expect(made.mock.calls[0]![0].type).toBe('image/svg+xml')
  vi.unstubAllGlobals()
})
