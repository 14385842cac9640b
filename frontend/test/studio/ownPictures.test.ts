import { expect, test } from 'vitest'
import { Store } from '../../src/state'
import { Unusable } from '../../src/studio/faultText'
import { Herbarium } from '../../src/studio/ownPictures'
import { photo } from '../builders'

const leaf = new Blob(['leaf'])

test('a leaf is taken, and one that is of no use leaves it there and says why', async () => {
  const store = new Store()
  let good = true
  const herbarium = new Herbarium(store, async file => {
    if (!good) throw new Unusable('It is no PNG.')
    return file
  })
  await herbarium.take(leaf)
  expect(store.state.leaf).toBe(leaf)
  good = false
  await herbarium.take(new Blob(['other']))
  expect([store.state.leaf, store.state.faults.leaf?.text]).toEqual([leaf, 'It is no PNG.'])
  herbarium.drop()
  expect([store.state.leaf, store.state.faults.leaf]).toEqual([null, undefined])
})

test('a leaf that was still being read does not go to another drawing', async () => {
  const store = new Store()
  store.set({ photo: photo() })
  const taking = new Herbarium(store, async file => file).take(leaf)
  store.set({ photo: photo({ id: 'pho_2' }) })
  await taking
  expect(store.state.leaf).toBeNull()
})
