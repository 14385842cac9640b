import { expect, test } from 'vitest'
import { Refused, Unreachable } from '../../src/api/client'
import { faultOf, strokeAt, Unusable } from '../../src/studio/sentences'

test.each([
  ['/crown', { kind: 'crown', index: 0 }],
  ['/branches/2', { kind: 'branch', index: 2 }],
  ['/branches/2/points/7', { kind: 'branch', index: 2 }],
  ['/strokes/erase/1', { kind: 'erase', index: 1 }],
  ['/strokes/scale/metres', { kind: 'scale', index: 0 }],
  ['/front/branches/2', { kind: 'branch', index: 2 }],
  ['/side/crown', { kind: 'crown', index: 0, sheet: 'side' }],
  ['/sketches/side/branches/1/points/3', { kind: 'branch', index: 1, sheet: 'side' }],
  ['/settings/height', null],
  [null, null],
])('the pointer %s leads to %o', (pointer, stroke) => {
  expect(strokeAt(pointer)).toEqual(stroke)
})

test("the service's words become a sentence without their place", () => {
  const fault = faultOf(new Refused(422, 'other', 'settings/height: 900 is too high; give 0.1 to 150', null))
  expect(fault).toEqual({ text: '900 is too high; give 0.1 to 150.' })
})

test('a service that does not answer is told apart from one that refuses', () => {
  expect(faultOf(new Unreachable()).text).toContain('Your drawing is safe')
  expect(faultOf(new Unusable('Draw it longer.')).text).toBe('Draw it longer.')
})

test('an error of the page itself is not hidden', () => {
  expect(() => faultOf(new RangeError('ours'))).toThrow('ours')
})
