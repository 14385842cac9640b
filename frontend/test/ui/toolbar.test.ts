// @vitest-environment jsdom
import 'fake-indexeddb/auto'
import { beforeEach, expect, test } from 'vitest'
import type { Line } from '../../src/strokes'
import { Studio } from '../../src/studio/studio'
import { toolbar } from '../../src/ui/toolbar'

const LINE: Line = [
  [0, 0],
  [9, 0],
  [9, 9],
]
let studio: Studio
const named = (name: string) => document.querySelector<HTMLButtonElement>(`[title^="${name}"]`)!
const rows = () => [...document.querySelectorAll('.stroke-name')].map(row => row.textContent)

beforeEach(() => {
  studio = new Studio()
  document.body.replaceChildren(toolbar(studio))
})

test('one tool is held, and a click takes another', () => {
  const held = () => [...document.querySelectorAll<HTMLElement>('[aria-pressed="true"]')].map(one => one.dataset.tool)
  expect(held()).toEqual(['crown'])
  named('Select').click()
  expect(held()).toEqual(['select'])
  expect(studio.store.state.tool).toBe('select')
})

test('what cannot be done is said to be disabled and does nothing, but keeps the focus', () => {
  const undo = named('Undo')
  expect(undo.getAttribute('aria-disabled')).toBe('true')
  expect(undo.disabled).toBe(false)
  studio.sketchbook.draw('crown', LINE)
  expect(undo.getAttribute('aria-disabled')).toBe('false')
  undo.click()
  expect(studio.store.strokes.crown).toBeNull()
  expect(undo.getAttribute('aria-disabled')).toBe('true')
})

test('the list names every stroke, and deletes and selects them', () => {
  studio.sketchbook.draw('crown', LINE)
  studio.sketchbook.draw('branch', LINE)
  studio.sketchbook.draw('branch', LINE)
  expect(rows()).toEqual(['Crown', 'Trunk', 'Branch 2'])
  document.querySelectorAll<HTMLElement>('.stroke-name')[1]!.click()
  expect(studio.store.state.selection).toEqual({ kind: 'branch', index: 0 })
  document.querySelector<HTMLElement>('[aria-label="Delete Crown"]')!.click()
  expect(rows()).toEqual(['Trunk', 'Branch 2'])
})

test('the focus stays in the list when its row is deleted', () => {
  studio.sketchbook.draw('crown', LINE)
  studio.sketchbook.draw('branch', LINE)
  const last = document.querySelector<HTMLElement>('[aria-label="Delete Trunk"]')!
  last.focus()
  last.click()
  expect(document.activeElement?.textContent).toBe('Crown')
})

test('clearing is one edit that undo takes back', () => {
  studio.sketchbook.draw('crown', LINE)
  studio.sketchbook.draw('branch', LINE)
  named('Clear').click()
  expect(rows()).toEqual([])
  named('Undo').click()
  expect(rows()).toEqual(['Crown', 'Trunk'])
})
