import { Quaternion, Vector3 } from 'three'
import { expect, test } from 'vitest'
import { magnify, meanTurn } from '../../src/preview/gain'

const AXIS = new Vector3(0, 0, 1)
const turns = (...degrees: number[]) =>
  degrees.flatMap(one => new Quaternion().setFromAxisAngle(AXIS, (one * Math.PI) / 180).toArray())
const degreesOf = ([, , z, w]: ArrayLike<number> & Iterable<number>) => (2 * Math.atan2(z!, w!) * 180) / Math.PI

function magnified(gain: number, values: number[]) {
  const to = new Float32Array(values.length)
  magnify(values, meanTurn(values), gain, to)
  return [0, 1].map(at => degreesOf(to.slice(4 * at, 4 * at + 4)))
}

test('the mean lies between, whatever the sign of a quaternion', () => {
  const [a, b] = [turns(10), turns(30).map(part => -part)]
  expect(degreesOf(meanTurn([...a, ...b]).toArray())).toBeCloseTo(20, 3)
})

test('a gain scales how far each turns from the mean', () => {
  expect(magnified(2, turns(10, 30))[0]).toBeCloseTo(0, 3)
  expect(magnified(2, turns(10, 30))[1]).toBeCloseTo(40, 3)
  expect(magnified(0, turns(10, 30))[0]).toBeCloseTo(20, 3)
  expect(magnified(1, turns(10, 30))[1]).toBeCloseTo(30, 3)
})

test('a branch that never turns stays', () => {
  expect(magnified(3, turns(15, 15))[0]).toBeCloseTo(15, 3)
})
