import { expect, test } from 'vitest'
import type { Grown } from '../../../src/api/types'
import { Store } from '../../../src/state'
import { followState } from '../../../src/ui/tree/previewContent'
import { grown, model, photo, photoSheets, shownModel } from '../../builders'
import { settle } from '../../service'

const GLB = new ArrayBuffer(4)

/** Stands in for the preview: says what it was told to show, and ends the growth when the test wants it. */
class Stage {
  readonly told: string[] = []
  end = () => {}
  breaks = false

  showPhoto(url: string | null): void {
    this.told.push(`photo ${url}`)
  }

  showLive({ points }: Grown): void {
    this.told.push(`live ${points.length}`)
  }

  playGrowth({ points }: Grown): Promise<void> {
    this.told.push(`growth ${points.length}`)
    return new Promise(end => {
      this.end = end
    })
  }

  async showModel(glb: ArrayBuffer): Promise<void> {
    if (this.breaks) throw new Error('no GLB')
    this.told.push(`tree ${glb.byteLength}`)
  }

  clear(): void {
    this.told.push('clear')
  }
}

function begin() {
  const store = new Store()
  const stage = new Stage()
  followState(store, stage)
  store.set({ sheets: photoSheets() })
  stage.told.length = 0
  return { store, stage }
}

test('photo and live tree are shown as they come, and cleared as they go', () => {
  const { store, stage } = begin()
  store.set({ sheets: photoSheets(photo({ url: 'blob:other' })), liveTree: grown(3) })
  store.set({ online: false })
  store.set({ liveTree: grown(4) })
  store.set({ liveTree: null, sheets: null })
  expect(stage.told).toEqual(['photo blob:other', 'live 3', 'live 4', 'photo null', 'clear'])
})

test('a growing tree is played from its growth, and the finished one waits for its end', async () => {
  const { store, stage } = begin()
  store.set({ liveTree: grown(3) })
  store.set({ model: shownModel(), shows: 'model' })
  store.setModel('mdl_1', { growth: grown(9) })
  store.setModel('mdl_1', { info: model({ status: 'succeeded' }), glb: GLB })
  await settle()
  expect(stage.told).toEqual(['live 3', 'growth 9'])
  stage.end()
  await settle()
  expect(stage.told).toEqual(['live 3', 'growth 9', 'tree 4'])
})

test('a tree that is opened finished is shown at once, though its growth is told', async () => {
  const { store, stage } = begin()
  store.set({ model: shownModel({ status: 'succeeded' }), shows: 'model' })
  store.setModel('mdl_1', { growth: grown(9) })
  store.setModel('mdl_1', { glb: GLB })
  await settle()
  expect(stage.told).toEqual(['tree 4'])
})

test('what is drawn while growth is played takes its place, and the tree of before does not come', async () => {
  const { store, stage } = begin()
  store.set({ model: shownModel(), shows: 'model' })
  store.setModel('mdl_1', { growth: grown(9) })
  store.setModel('mdl_1', { glb: GLB })
  store.set({ liveTree: grown(5), shows: 'live' })
  stage.end()
  await settle()
  expect(stage.told).toEqual(['growth 9', 'live 5'])
  store.set({ shows: 'model' })
  await settle()
  expect(stage.told.at(-1)).toBe('tree 4')
})

test('another model meanwhile lets the first one go', async () => {
  const { store, stage } = begin()
  store.set({ liveTree: grown(3), model: shownModel(), shows: 'model' })
  store.setModel('mdl_1', { growth: grown(9) })
  store.setModel('mdl_1', { glb: GLB })
  store.set({ model: shownModel({ id: 'mdl_2' }) })
  stage.end()
  await settle()
  expect(stage.told).toEqual(['live 3', 'growth 9', 'live 3'])
})

test('a tree that cannot be shown is said in its place, and forgotten when one can', async () => {
  const { store, stage } = begin()
  stage.breaks = true
  store.set({ model: shownModel({ status: 'succeeded' }, { glb: GLB }), shows: 'model' })
  await settle()
  expect(store.state.faults.preview?.text).toContain('cannot be shown')
  stage.breaks = false
  store.setModel('mdl_1', { glb: new ArrayBuffer(8) })
  await settle()
  expect(store.state.faults.preview).toBeUndefined()
})
