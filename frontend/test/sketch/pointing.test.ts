import { expect, test } from 'vitest'
import { wheelIntent } from '../../src/sketch/pointing'

const turn = (change: Partial<WheelEvent>) =>
  wheelIntent({ deltaX: 0, deltaY: 0, deltaMode: 0, ctrlKey: false, shiftKey: false, ...change }, [30, 40])

test('the wheel zooms about the pointer, and the opposite turn undoes it', () => {
  const [nearer, farther] = [turn({ deltaY: -100 }), turn({ deltaY: 100 })]
  if (nearer.type !== 'pinch' || farther.type !== 'pinch') throw new Error('not a zoom')
  expect(nearer).toMatchObject({ about: [30, 40], by: [0, 0] })
  expect(nearer.factor).toBeGreaterThan(1.1)
  expect(nearer.factor * farther.factor).toBeCloseTo(1, 12)
})

test("a trackpad's pinch, which turns little, zooms more for each turn", () => {
  expect(turn({ deltaY: -3, ctrlKey: true })).toMatchObject({ factor: Math.exp(0.03) })
})

test('lines and pages turn more than pixels, and one turn never zooms far', () => {
  const factors = [turn({ deltaY: -1 }), turn({ deltaY: -1, deltaMode: 1 }), turn({ deltaY: -9, deltaMode: 2 })].map(
    intent => (intent.type === 'pinch' ? intent.factor : 0),
  )
  expect(factors).toEqual(factors.toSorted())
  expect(factors[2]).toBeLessThan(1.4)
})

test('with Shift, or sideways, the wheel pans', () => {
  expect(turn({ deltaY: 50, shiftKey: true })).toEqual({ type: 'pan', by: [-50, 0] })
  expect(turn({ deltaX: 50, shiftKey: true })).toEqual({ type: 'pan', by: [-50, 0] })
  expect(turn({ deltaX: 7, deltaY: -20 })).toEqual({ type: 'pan', by: [-7, 20] })
})
