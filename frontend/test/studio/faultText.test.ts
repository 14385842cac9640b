import { expect, test } from 'vitest'
import { Refused, Unreachable } from '../../src/api/request'
import { faultOf, PageFault } from '../../src/studio/faultText'

test("the service's message becomes a sentence without the field's path", () => {
  const fault = faultOf(new Refused(422, 'other', 'settings/height: 900 is too high; give 0.1 to 150', null))
  expect(fault).toEqual({ text: '900 is too high; give 0.1 to 150.' })
})

test('a service that does not answer has another sentence than one that refuses', () => {
  expect(faultOf(new Unreachable()).text).toContain('Your drawing is safe')
  expect(faultOf(new PageFault('Draw it longer.')).text).toBe('Draw it longer.')
})

test('an error of the page itself is not hidden', () => {
  expect(() => faultOf(new RangeError('ours'))).toThrow('ours')
})

test('of a quota it is said when to try again', () => {
  const full = new Refused(429, 'queue_full', 'as many trees wait as may', null, 600)
  expect(faultOf(full).text).toBe('As many trees wait as your team may have waiting. Try again in 10 min.')
  const day = new Refused(429, 'quota_exceeded', 'your team has asked for 500 models in 24 hours', null, 7200)
  expect(faultOf(day).text).toBe('Your team has asked for 500 models in 24 hours. Try again in 2 hr.')
})
