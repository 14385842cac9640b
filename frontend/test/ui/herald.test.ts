import { expect, test } from 'vitest'
import { begin } from '../../src/history'
import { type State, Store } from '../../src/state'
import { withStroke } from '../../src/strokes'
import { heraldGrowth } from '../../src/ui/herald'
import { CROWN, model, photo, TRUNK } from '../builders'

function listen() {
  const store = new Store()
  const said: string[] = []
  const clock = { ms: 0 }
  const drawn = withStroke(withStroke(store.strokes, 'crown', CROWN), 'branch', TRUNK)
  store.set({ photo: photo(), history: begin(drawn), modelOf: drawn })
  heraldGrowth(
    store,
    sentence => said.push(sentence),
    () => clock.ms,
  )
  const at = (ms: number, change: Partial<State>) => {
    clock.ms = ms
    store.set(change)
  }
  const step = (ms: number, phase: string, progress = 0) =>
    at(ms, { model: model({ status: 'running', phase, progress }) })
  return { said, at, step }
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
  const { said, at, step } = listen()
  step(0, 'grow')
  const done = model({ status: 'succeeded', score: { silhouette_iou: 0.93 } })
  at(100, { model: done })
  at(200, { tree: new ArrayBuffer(1) })
  at(300, { online: true })
  expect(said).toEqual([
    'Growing branches',
    'The tree is grown. 93% match with the foliage and branches as they were read. A very close likeness.',
  ])
})

test('a failure is said in its own words, and a cancel as such', () => {
  const { said, at, step } = listen()
  step(0, 'grow')
  at(100, { faults: { grow: { text: 'The disk is full.' } }, model: model({ status: 'failed' }) })
  step(9000, 'grow')
  at(9100, { faults: {}, model: model({ status: 'canceled' }) })
  expect([said[1], said[3]]).toEqual(['The disk is full.', 'Growing was canceled. Your strokes are as they were.'])
})

test('a tree that is opened finished is not announced as grown', () => {
  const { said, at } = listen()
  at(0, { model: model({ status: 'succeeded' }), tree: new ArrayBuffer(1) })
  expect(said).toEqual([])
})
