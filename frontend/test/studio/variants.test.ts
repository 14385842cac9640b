import { expect, test } from 'vitest'
import { groveOf, siblingsOf, treeFiles, treeOf, variantsOf, withVariant } from '../../src/studio/variants'
import { model } from '../builders'

const files = {
  'tree.glb': '/1',
  'tree.v12.glb': '/12',
  'tree.v12.lod1.glb': '/12l',
  project: '/p',
  'preview.png': '/i',
}
const trees = [
  { seed: 4, score: { silhouette_iou: 0.9 }, counts: { leaves: 10 } },
  { seed: 5, score: { silhouette_iou: 0.8 }, counts: { leaves: 20 } },
]

test('files of trees are found among others, with their tree’s number', () => {
  const grown = model({ files })
  expect(treeFiles(grown).map(({ variant, what }) => [variant, what])).toEqual([
    [1, 'glb'],
    [12, 'glb'],
    [12, 'lod1.glb'],
  ])
  expect([variantsOf(grown), treeOf(grown, 1), treeOf(grown, 12), treeOf(grown, 3)]).toEqual([
    2,
    '/1',
    '/12',
    undefined,
  ])
})

test('siblings are told from the tree and its variants', () => {
  const grown = model({
    files: { 'tree.glb': '/1', 'tree.s1.glb': '/s1', 'tree.s12.glb': '/s12', 'tree.grove.glb': '/g' },
  })
  expect([variantsOf(grown), siblingsOf(grown), groveOf(grown)]).toEqual([1, 2, '/g'])
  expect([treeOf(grown, 1), treeOf(grown, 1, 12), treeOf(grown, 1, 2)]).toEqual(['/1', '/s12', undefined])
})

test('one of several trees has its own score and counts, and what they have in common', () => {
  const grown = model({
    score: { silhouette_iou: 0.9 },
    report: { seconds: { grow: 1 }, variants: trees, files: { 'tree.v2.glb': 7 } },
  })
  const second = withVariant(grown, 2)
  expect([second.score, second.report?.counts, second.report?.seconds]).toEqual([
    { silhouette_iou: 0.8 },
    { leaves: 20, bytes: 7 },
    { grow: 1 },
  ])
  expect(withVariant(grown, 3)).toBe(grown)
})
