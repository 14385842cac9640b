import { expect, test } from 'vitest'
import type { Model } from '../../src/api/types'
import { EMPTY, type Photo } from '../../src/state'
import { titleOf } from '../../src/ui/title'

const photo = { id: 'photo' } as Photo
const model = (status: Model['status'], progress: number) => ({ status, progress }) as Model

test('without a photo the title is the page', () => {
  expect(titleOf({ ...EMPTY, name: 'gone' })).toBe('treestroke')
})

test('a drawing gives its name, and has one without a name', () => {
  expect(titleOf({ ...EMPTY, photo, name: 'Old oak' })).toBe('Old oak – treestroke')
  expect(titleOf({ ...EMPTY, photo })).toBe('Untitled tree – treestroke')
})

test('progress stands before the name while a tree grows, and no longer', () => {
  expect(titleOf({ ...EMPTY, photo, name: 'Old oak', model: model('running', 0.426) })).toBe('42 % – Old oak')
  expect(titleOf({ ...EMPTY, photo, name: 'Old oak', model: model('succeeded', 1) })).toBe('Old oak – treestroke')
})

test('asking for another tree begins at nought', () => {
  expect(titleOf({ ...EMPTY, photo, name: 'Old oak', asking: true, model: model('succeeded', 1) })).toBe(
    '0 % – Old oak',
  )
})
