// @vitest-environment jsdom
import { expect, test, vi } from 'vitest'
import { listenToClicks } from '../../src/preview/clicks'

function begin() {
  const element = document.createElement('div')
  const clicked = vi.fn()
  const listening = new AbortController()
  listenToClicks(element, listening.signal, clicked)
  const pointer = (type: string, clientX: number, changes = {}) => {
    const event = new MouseEvent(`pointer${type}`, { clientX, clientY: 5 })
    element.dispatchEvent(Object.assign(event, { pointerId: 1, isPrimary: true, ...changes }))
  }
  return { clicked, pointer, listening }
}

test('a press and release at one place is a click there', () => {
  const { clicked, pointer } = begin()
  pointer('down', 20)
  pointer('up', 22)
  expect(clicked).toHaveBeenCalledWith([22, 5])
})

test('a drag is none, nor is a second finger', () => {
  const { clicked, pointer } = begin()
  pointer('down', 20)
  pointer('up', 40)
  pointer('down', 20, { isPrimary: false })
  pointer('up', 20)
  expect(clicked).not.toHaveBeenCalled()
})

test('nothing is heard once the signal has ended it', () => {
  const { clicked, pointer, listening } = begin()
  listening.abort()
  pointer('down', 20)
  pointer('up', 20)
  expect(clicked).not.toHaveBeenCalled()
})
