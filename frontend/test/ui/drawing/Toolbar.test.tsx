// @vitest-environment jsdom
import 'fake-indexeddb/auto'
import { act } from 'preact/test-utils'
import { beforeEach, expect, test } from 'vitest'
import type { Line, StrokeKind } from '../../../src/strokes'
import { Studio } from '../../../src/studio/studio'
import { Toolbar } from '../../../src/ui/drawing/Toolbar'
import { mount } from '../mount'

const LINE: Line = [
  [0, 0],
  [9, 0],
  [9, 9],
]
let studio: Studio
const named = (name: string) => document.querySelector<HTMLButtonElement>(`[title^="${name}"]`)!
const rows = () => [...document.querySelectorAll('.stroke-name')].map(row => row.textContent)

/** Draw a stroke of its own, and let the bar follow. */
const draw = (kind: StrokeKind) => act(() => studio.strokes.draw(kind, [...LINE]))
const click = (button: HTMLElement) => act(() => button.click())

beforeEach(async () => {
  studio = new Studio()
  mount(studio, <Toolbar />)
})

test('one tool is chosen, and a click chooses another', async () => {
  const held = () => [...document.querySelectorAll<HTMLElement>('[aria-pressed="true"]')].map(one => one.dataset.tool)
  expect(held()).toEqual(['crown'])
  await click(named('Select'))
  expect(held()).toEqual(['select'])
  expect(studio.store.state.tool).toBe('select')
})

test('a button that can do nothing is marked as disabled, but can have the focus', async () => {
  const undo = named('Undo')
  expect(undo.getAttribute('aria-disabled')).toBe('true')
  expect(undo.disabled).toBe(false)
  await draw('crown')
  expect(undo.getAttribute('aria-disabled')).toBe('false')
  await click(undo)
  expect(studio.store.strokes.crown).toBeNull()
  expect(undo.getAttribute('aria-disabled')).toBe('true')
})

test('the list names every stroke, and deletes and selects them', async () => {
  await draw('crown')
  await draw('branch')
  await draw('branch')
  expect(rows()).toEqual(['Crown', 'Trunk', 'Branch 2'])
  await click(document.querySelectorAll<HTMLElement>('.stroke-name')[1]!)
  expect(studio.store.state.selection).toEqual({ kind: 'branch', index: 0 })
  await click(document.querySelector<HTMLElement>('[aria-label="Delete Crown"]')!)
  expect(rows()).toEqual(['Trunk', 'Branch 2'])
})

test('the focus stays in the list when its row is deleted', async () => {
  await draw('crown')
  await draw('branch')
  const last = document.querySelector<HTMLElement>('[aria-label="Delete Trunk"]')!
  last.focus()
  await click(last)
  expect(document.activeElement?.textContent).toBe('Crown')
})

test('clearing is one edit that undo takes back', async () => {
  await draw('crown')
  await draw('branch')
  await click(named('Clear'))
  expect(rows()).toEqual([])
  await click(named('Undo'))
  expect(rows()).toEqual(['Crown', 'Trunk'])
})
