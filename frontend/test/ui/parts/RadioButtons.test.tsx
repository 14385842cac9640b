// @vitest-environment jsdom
import 'fake-indexeddb/auto'
import { expect, test, vi } from 'vitest'
import { Studio } from '../../../src/studio/studio'
import { RadioButtons } from '../../../src/ui/parts/RadioButtons'
import { mount } from '../mount'

const CHOICES = [
  ['leaves', 'Leaves'],
  ['needles', 'Needles'],
  ['bare', 'Bare'],
] as const

function begin(chosen: string) {
  const choose = vi.fn()
  const host = mount(
    new Studio(),
    <RadioButtons label="Kind of tree" choices={CHOICES} chosen={chosen} choose={choose} />,
  )
  const buttons = [...host.querySelectorAll('button')]
  const press = (key: string) =>
    document.activeElement!.dispatchEvent(new KeyboardEvent('keydown', { key, bubbles: true, cancelable: true }))
  return { host, buttons, choose, press }
}

test('one name is chosen, and Tab leads to it', () => {
  const { host, buttons } = begin('needles')
  expect(host.querySelector('[role=radiogroup]')!.getAttribute('aria-label')).toBe('Kind of tree')
  expect(buttons.map(button => button.getAttribute('aria-checked'))).toEqual(['false', 'true', 'false'])
  expect(buttons.map(button => button.tabIndex)).toEqual([-1, 0, -1])
})

test('while none of them is chosen, Tab leads to the first', () => {
  expect(begin('moss').buttons.map(button => button.tabIndex)).toEqual([0, -1, -1])
})

test('arrow keys go from one to the next and round without choosing', () => {
  const { buttons, choose, press } = begin('needles')
  buttons[1]!.focus()
  const ways = ['ArrowDown', 'ArrowRight', 'ArrowUp', 'ArrowLeft', 'Home', 'End']
  const focused = ways.map(key => {
    press(key)
    return document.activeElement!.textContent
  })
  expect(focused).toEqual(['Bare', 'Leaves', 'Bare', 'Needles', 'Leaves', 'Bare'])
  expect(choose).not.toHaveBeenCalled()
})

test('a click chooses', () => {
  const { buttons, choose } = begin('needles')
  buttons[2]!.click()
  expect(choose).toHaveBeenCalledWith('bare')
})
