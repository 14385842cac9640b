import { expect, test } from 'vitest'
import type { Model } from '../../../src/api/types'
import { EMPTY } from '../../../src/state'
import { titleOf } from '../../../src/ui/start/title'
import { photoSheets, shownModel } from '../../builders'

const open = { ...EMPTY, sheets: photoSheets() }
const model = (status: Model['status'], progress: number) => shownModel({ status, progress })

test('without a photo the title is the page', () => {
  expect(titleOf({ ...EMPTY, name: 'gone' })).toBe('treestroke')
})

test('a drawing gives its name, and has one without a name', () => {
  expect(titleOf({ ...open, name: 'Old oak' })).toBe('Old oak – treestroke')
  expect(titleOf(open)).toBe('Untitled tree – treestroke')
})

test('progress stands before the name while a tree grows, and no longer', () => {
  expect(titleOf({ ...open, name: 'Old oak', model: model('running', 0.426) })).toBe('42% – Old oak')
  expect(titleOf({ ...open, name: 'Old oak', model: model('succeeded', 1) })).toBe('Old oak – treestroke')
})

test('asking for another tree begins at 0 %', () => {
  expect(titleOf({ ...open, name: 'Old oak', asking: true, model: model('succeeded', 1) })).toBe('0% – Old oak')
})
