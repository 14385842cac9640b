import { expect, test } from 'vitest'
import { measuresOf } from '../../../src/ui/tree/measures'
import { model } from '../../builders'

const measures = {
  height: { value: 12.34, unit: 'm', low: 11, high: 14, basis: 'measured', meaning: 'from root to top' },
  trunk_diameter: { value: 0.421, unit: 'm', low: 0.38, high: 0.46, basis: 'derived', meaning: '' },
  crown_volume: { value: 1234.5, unit: 'm³', low: 900, high: 1600, basis: 'derived', meaning: '' },
  leaf_area: { value: null, unit: 'm²', low: null, high: null, basis: 'assumed', meaning: '' },
  branches_by_order: { value: [1, 12, 1086], unit: '', basis: 'derived', meaning: '' },
  scale: { value: 0.0213, unit: 'm/px', basis: 'given' },
  hollow_trees: { value: 3, unit: '', basis: 'guessed', meaning: 'how many are hollow' },
}
const listed = measuresOf(model({ report: { measures } }))

test('measures are written as people write them', () => {
  expect(listed.map(({ value }) => value)).toEqual([
    '12.3 m',
    '42.1 cm',
    '1,235 m³',
    'Not known',
    '1 · 12 · 1,086',
    '2.13 cm per pixel',
    '3',
  ])
})

test('a range and how sure it is stand beside the value', () => {
  expect(listed.slice(0, 4).map(({ range }) => range)).toEqual(['11 to 14 m', '38 to 46 cm', '900 to 1,600 m³', ''])
  expect(listed.map(({ basis }) => basis?.[0])).toEqual(
    expect.arrayContaining(['measured', 'derived', 'assumed', 'given', 'guessed']),
  )
})

test('a measure that the page does not know is told in the service’s words', () => {
  expect(listed.at(-1)).toMatchObject({ label: 'Hollow trees', why: 'how many are hollow' })
})

test('a model without measures has none', () => {
  expect(measuresOf(model())).toEqual([])
})
