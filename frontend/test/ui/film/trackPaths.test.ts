import { expect, test } from 'vitest'
import { pathsAt } from '../../../src/ui/film/trackPaths'

const line = (count: number) => Array.from({ length: count }, (_, at) => [at, 2 * at] as [number, number])
const tracks = (points: ([number, number] | null)[][], every = 1) => ({ frames_per_second: 30, every, points })

test('a point shows where it is and a short tail of where it came from', () => {
  const [path] = pathsAt(tracks([line(40)]), 20)
  expect(path!.way.at(-1)).toEqual([20, 40])
  expect(path!.way[0]).toEqual([11, 22])
})

test('a tail ends where the point was not seen', () => {
  const [path] = pathsAt(tracks([[[0, 0], null, [2, 2], [3, 3]]]), 3)
  expect(path!.way).toEqual([
    [2, 2],
    [3, 3],
  ])
})

test('a point that is not seen in the frame is left out', () => {
  expect(pathsAt(tracks([[[0, 0], null], line(2)]), 1).map(({ track }) => track)).toEqual([1])
  expect(pathsAt(tracks([line(2)]), 9)).toEqual([])
})

test('of very many points only a part is shown', () => {
  const shown = pathsAt(tracks(Array.from({ length: 1000 }, () => line(2))), 1)
  expect([shown.length > 150, shown.length <= 260]).toEqual([true, true])
})

test('places that are some frames apart are found', () => {
  expect(pathsAt(tracks([line(10)], 3), 10)[0]!.way.at(-1)).toEqual([3, 6])
})
