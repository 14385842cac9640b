import { expect, test } from 'vitest'
import type { Model } from '../../../src/api/types'
import { begin } from '../../../src/history'
import { type ShownModel, type State, Store } from '../../../src/state'
import { withStroke } from '../../../src/strokes'
import { announceGrowth } from '../../../src/ui/tree/announceGrowth'
import { CROWN, photoSheets, shownModel, TRUNK } from '../../builders'

function listen() {
  const store = new Store()
  const said: string[] = []
  const clock = { ms: 0 }
  const drawn = withStroke(withStroke(store.strokes, 'crown', CROWN), 'branch', TRUNK)
  store.set({ sheets: photoSheets(), history: begin(drawn) })
  store.watch(
    state => state.announcement,
    sentence => sentence && said.push(sentence),
  )
  announceGrowth(store, () => clock.ms)
  const at = (ms: number, change: Partial<State>) => {
    clock.ms = ms
    store.set(change)
  }
  const modelAt = (ms: number, info: Partial<Model>, changes: Partial<ShownModel> = {}) =>
    at(ms, { model: shownModel(info, { strokes: drawn, ...changes }) })
  const step = (ms: number, phase: string, progress = 0) => modelAt(ms, { status: 'running', phase, progress })
  return { drawn, said, at, modelAt, step }
}

test('steps are said, not oftener than one can listen to, and not each per cent', () => {
  const { said, step } = listen()
  step(0, 'decode')
  step(100, 'decode', 0.1)
  step(1000, 'foliage', 0.2)
  step(3000, 'grow', 0.4)
  step(6000, 'grow', 0.6)
  expect(said).toEqual(['Reading the photo', 'Growing branches'])
})

test('the end is always said, once', () => {
  const { said, at, modelAt, step } = listen()
  step(0, 'grow')
  const done = { status: 'succeeded', score: { silhouette_iou: 0.93 } } as const
  modelAt(100, done)
  modelAt(200, done, { glb: new ArrayBuffer(1) })
  at(300, { online: true })
  expect(said).toEqual([
    'Growing branches',
    'The tree is grown. 93% match with the foliage and branches. A very close match.',
  ])
})

test('a failure is said in its own words, and a cancel as such', () => {
  const { drawn, said, at, step } = listen()
  step(0, 'grow')
  at(100, { faults: { grow: { text: 'The disk is full.' } }, model: shownModel({ status: 'failed' }) })
  step(9000, 'grow')
  at(9100, { faults: {}, model: shownModel({ status: 'canceled' }, { strokes: drawn }) })
  expect([said[1], said[3]]).toEqual(['The disk is full.', 'Growing was canceled. Your strokes are unchanged.'])
})

test('a tree that is opened finished is not announced as grown', () => {
  const { said, modelAt } = listen()
  modelAt(0, { status: 'succeeded' }, { glb: new ArrayBuffer(1) })
  expect(said).toEqual([])
})
