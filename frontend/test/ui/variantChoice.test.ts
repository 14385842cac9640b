// @vitest-environment jsdom
import 'fake-indexeddb/auto'
import { expect, test, vi } from 'vitest'
import { Studio } from '../../src/studio/studio'
import { variantChoice } from '../../src/ui/variantChoice'
import { model } from '../builders'

function choiceOf(count: number) {
  const names = Array.from({ length: count }, (_, at) => (at ? `tree.v${at + 1}.glb` : 'tree.glb'))
  const studio = new Studio()
  const choose = vi.spyOn(studio.grower, 'choose').mockResolvedValue()
  const element = variantChoice(studio)
  const files = Object.fromEntries(names.map(name => [name, `/${name}`]))
  studio.store.set({ model: model({ status: 'succeeded', files }), tree: new ArrayBuffer(4) })
  return { element, choose, studio, buttons: [...element.querySelectorAll('button')] }
}

test('a single tree leaves nothing to choose', () => {
  expect(choiceOf(1).element.hidden).toBe(true)
})

test('each of several trees has a number, the one that is looked at is marked', () => {
  const { element, buttons, choose, studio } = choiceOf(3)
  expect([element.hidden, buttons.map(one => one.textContent)]).toEqual([false, ['1', '2', '3']])
  buttons[1]!.click()
  expect(choose).toHaveBeenCalledWith(2)
  studio.store.set({ variant: 2 })
  expect(buttons.map(one => one.getAttribute('aria-pressed'))).toEqual(['false', 'true', 'false'])
})

test('many trees are chosen from a list', () => {
  const { element, choose } = choiceOf(9)
  expect(element.classList.contains('many')).toBe(true)
  const list = element.querySelector('select')!
  list.value = '7'
  list.dispatchEvent(new Event('change'))
  expect([list.options.length, choose.mock.calls]).toEqual([9, [[7]]])
})
