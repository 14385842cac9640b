import { expect, test } from 'vitest'
import { detailsOf } from '../../../src/preview/grove/detail'

const seen = (...heights: number[]) => heights.map(height => ({ height, isInView: true }))
const BUDGET = { near: 1, middle: 2 }

test('the largest on the screen are drawn in most detail, as many as the budget allows', () => {
  expect(detailsOf(seen(500, 90, 900, 300, 700), BUDGET)).toEqual(['middle', 'far', 'near', 'far', 'middle'])
})

test('small trees are pictures, however much there is left', () => {
  expect(detailsOf(seen(20, 140), BUDGET)).toEqual(['far', 'far'])
})

test('what is out of view is not drawn, and takes nothing of the budget', () => {
  const trees = [...seen(600), { height: 4000, isInView: false }]
  expect(detailsOf(trees, BUDGET)).toEqual(['near', null])
})
