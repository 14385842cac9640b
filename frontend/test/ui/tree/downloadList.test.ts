import { expect, test } from 'vitest'
import { downloadsOf } from '../../../src/ui/tree/downloadList'
import { model } from '../../builders'

const names = ['tree.swc', 'tree.obj.zip', 'tree.lod2.glb', 'tree.glb', 'tree.v2.glb', 'tree.v2.lod1.glb', 'tree.moss']
const files = Object.fromEntries(names.map(name => [name, `/m/${name}`]))
const grown = model({ name: 'Oak', files, report: { counts: { bytes: 5_000_000 }, files: { 'tree.swc': 12_000 } } })

test('every file has a name, what it is good for, and its size where it is known', () => {
  const downloads = downloadsOf(grown, 1)
  expect(downloads.map(({ group, label, size }) => [group, label, size])).toEqual([
    ['tree', '3D tree', '5 MB'],
    ['levels', 'Far away', undefined],
    ['formats', 'Wavefront OBJ', undefined],
    ['formats', 'moss', undefined],
    ['skeleton', 'Skeleton, SWC', '12 kB'],
  ])
  expect(downloads.every(({ about }) => about.length > 3)).toBe(true)
})

test('another tree has its own files, named after it', () => {
  expect(downloadsOf(grown, 2).map(({ url, saved }) => [url, saved])).toEqual([
    ['/m/tree.v2.glb', 'Oak.v2.glb'],
    ['/m/tree.v2.lod1.glb', 'Oak.v2.lod1.glb'],
  ])
})

test('a single tree needs no number', () => {
  expect(downloadsOf(model({ name: 'Oak', files: { 'tree.glb': '/t' } }), 1)[0]!.saved).toBe('Oak.glb')
})
