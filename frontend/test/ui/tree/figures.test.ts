import { expect, test } from 'vitest'
import { figuresOfModel, judgementOf, makingOf, matchOf } from '../../../src/ui/tree/figures'
import { model } from '../../builders'

const grown = model({
  status: 'succeeded',
  score: { silhouette_iou: 0.922, attractors_reached: 0.978, depth_over_width: 0.966 },
  report: {
    seconds: { decode: 0.5, grow: 1.25 },
    counts: { iterations: 300, branches: 1137, leaves: 16237, triangles: 122971, bytes: 5172432 },
  },
})

test('the score card shows every figure as people write it', () => {
  const values = Object.fromEntries(figuresOfModel(grown).map(({ row, value }) => [row, value]))
  expect(values).toEqual({
    ...{ silhouette: '92%', reached: '98%', depth: '0.97 ×', branches: '1,137', leaves: '16,237' },
    ...{ triangles: '122,971', size: '5.2 MB', time: '1.8 sec' },
  })
  expect(figuresOfModel(grown).every(({ label, why }) => label && why)).toBe(true)
})

test('figures that the service does not give are left out', () => {
  expect(figuresOfModel(model())).toEqual([])
  expect(figuresOfModel({ ...grown, report: null }).map(({ row }) => row)).toEqual(['silhouette', 'reached', 'depth'])
})

test('one line says how well it fits and what it is made of', () => {
  expect(matchOf(grown)).toBe('92% match with the foliage and branches')
  expect(makingOf(grown)).toBe('122,971 triangles · 5.2 MB')
  expect(makingOf(model())).toBe('')
})

test('the judgement falls with the fit', () => {
  const judged = [0.95, 0.85, 0.7, 0.3].map(silhouette_iou => judgementOf(model({ score: { silhouette_iou } })))
  expect(new Set(judged).size).toBe(4)
  expect(judged[0]).toContain('very close')
})

test('a doubtful reading is not praised, but explained', () => {
  const reading = { against: 'the foliage', doubts: ['crown_unclear', 'kind_unsure'] }
  const doubted = model({ score: { silhouette_iou: 0.96 }, report: { reading } })
  expect(matchOf(doubted)).toBe('96% match, but the photo was hard to read')
  expect(judgementOf(doubted)).toContain('The crown looks much like what is around it.')
  expect(judgementOf(doubted)).toContain('whether the tree has leaves')
  expect(judgementOf(doubted)).not.toContain('close match')
})

test('a sketched tree is told by how much of the strokes is in it', () => {
  const score = { front_covered: 0.984, front_true: 1, in_planes: 0.1 }
  const alone = model({ status: 'succeeded', score })
  expect(matchOf(alone)).toBe('98% of the front strokes are in the tree')
  expect(judgementOf(alone)).toBe('The tree follows your strokes.')
  expect(figuresOfModel(alone).map(({ row, value }) => [row, value])).toEqual([
    ['frontCovered', '98%'],
    ['frontTrue', '100%'],
    ['inPlanes', '10%'],
  ])
  const both = { ...alone, score: { ...score, side_covered: 0.85 } }
  expect(matchOf(both)).toBe('98% of the front strokes and 85% of the side strokes are in the tree')
  expect(judgementOf(both)).toContain('strokes are missing')
  expect(matchOf({ ...both, score: { ...score, side_covered: 0.98 } })).toContain('98% of the strokes of both sides')
})
