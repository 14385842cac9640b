import { expect, test } from 'vitest'
import type { Grown } from '../../src/api/types'
import { Store } from '../../src/state'
import { followState } from '../../src/ui/follow'
import { grown, model, photo } from '../builders'
import { settle } from '../service'

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
  store.set({ photo: photo() })
  stage.told.length = 0
  return { store, stage }
}

test('photo and live tree are shown as they come, and cleared as they go', () => {
  const { store, stage } = begin()
  store.set({ photo: photo({ url: 'blob:other' }), grown: grown(3) })
  store.set({ online: false })
  store.set({ grown: grown(4) })
  store.set({ grown: null, photo: null })
  expect(stage.told).toEqual(['photo blob:other', 'live 3', 'live 4', 'photo null', 'clear'])
})

test('a growing tree is played from its growth, and the finished one waits for its end', async () => {
  const { store, stage } = begin()
  store.set({ grown: grown(3) })
  store.set({ model: model(), growth: null, tree: null, shows: 'model' })
  store.set({ growth: grown(9) })
  store.set({ model: model({ status: 'succeeded' }), tree: GLB })
  await settle()
  expect(stage.told).toEqual(['live 3', 'growth 9'])
  stage.end()
  await settle()
  expect(stage.told).toEqual(['live 3', 'growth 9', 'tree 4'])
})

test('a tree that is opened finished is shown at once, though its growth is told', async () => {
  const { store, stage } = begin()
  store.set({ model: model({ status: 'succeeded' }), shows: 'model' })
  store.set({ growth: grown(9) })
  store.set({ tree: GLB })
  await settle()
  expect(stage.told).toEqual(['tree 4'])
})

test('what is drawn while growth is played takes its place, and the tree of before does not come', async () => {
  const { store, stage } = begin()
  store.set({ model: model(), shows: 'model' })
  store.set({ growth: grown(9) })
  store.set({ tree: GLB })
  store.set({ grown: grown(5), shows: 'live' })
  stage.end()
  await settle()
  expect(stage.told).toEqual(['growth 9', 'live 5'])
  store.set({ shows: 'model' })
  await settle()
  expect(stage.told.at(-1)).toBe('tree 4')
})

test('another model meanwhile lets the first one go', async () => {
  const { store, stage } = begin()
  store.set({ grown: grown(3), model: model(), shows: 'model' })
  store.set({ growth: grown(9) })
  store.set({ tree: GLB })
  store.set({ model: model({ id: 'mdl_2' }), growth: null, tree: null })
  stage.end()
  await settle()
  expect(stage.told).toEqual(['live 3', 'growth 9', 'live 3'])
})

test('a tree that cannot be shown is said in its place, and forgotten when one can', async () => {
  const { store, stage } = begin()
  stage.breaks = true
  store.set({ model: model({ status: 'succeeded' }), tree: GLB, shows: 'model' })
  await settle()
  expect(store.state.faults.preview?.text).toContain('cannot be shown')
  stage.breaks = false
  store.set({ tree: new ArrayBuffer(8) })
  await settle()
  expect(store.state.faults.preview).toBeUndefined()
})
