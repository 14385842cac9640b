import { expect, test } from 'vitest'
import { Store } from '../../src/state'
import { PageFault } from '../../src/studio/faultText'
import { OwnPictureActions } from '../../src/studio/ownPictures'
import { photo, photoSheets } from '../builders'

const leaf = new Blob(['leaf'])

test('a leaf’s picture is used, and one that cannot be used leaves it with a fault', async () => {
  const store = new Store()
  let good = true
  const pictures = new OwnPictureActions(store, async file => {
    if (!good) throw new PageFault('It is no PNG.')
    return file
  })
  await pictures.use(leaf)
  expect(store.state.leaf).toBe(leaf)
  good = false
  await pictures.use(new Blob(['other']))
  expect([store.state.leaf, store.state.faults.leaf?.text]).toEqual([leaf, 'It is no PNG.'])
  pictures.remove()
  expect([store.state.leaf, store.state.faults.leaf]).toEqual([null, undefined])
})

test('a picture that is still being read does not go to another drawing', async () => {
  const store = new Store()
  store.set({ sheets: photoSheets() })
  const taking = new OwnPictureActions(store, async file => file).use(leaf)
  store.set({ sheets: photoSheets(photo({ id: 'pho_2' })) })
  await taking
  expect(store.state.leaf).toBeNull()
})
