import { expect, test, vi } from 'vitest'
import { FrameLoader } from '../../../src/ui/film/frameLoader'

type Picture = HTMLImageElement & { onload(): void; onerror(): void }

function loading(count = 60) {
  const asked: Picture[] = []
  const changed = vi.fn()
  const make = () => {
    const picture = { naturalWidth: 4, naturalHeight: 3 } as Picture
    asked.push(picture)
    return picture
  }
  return { asked, changed, loader: new FrameLoader(frame => `/${frame}`, count, changed, make) }
}

const addresses = (asked: readonly Picture[]) => asked.map(({ src }) => src)

test('the wanted frame comes first, then those after it, a few at once', () => {
  const { loader, asked, changed } = loading()
  loader.show(58)
  expect(addresses(asked)).toEqual(['/58', '/59', '/0'])
  expect(loader.still).toBeNull()
  asked[0]!.onload()
  expect(loader.still).toMatchObject({ image: asked[0], width: 4, height: 3 })
  expect([changed.mock.calls.length, addresses(asked).at(-1)]).toEqual([1, '/1'])
})

test('until a frame has come, what was shown stays; one that has come is not asked for again', () => {
  const { loader, asked } = loading()
  loader.show(0)
  asked[0]!.onload()
  loader.show(30)
  expect(loader.still?.image).toBe(asked[0])
  const before = asked.length
  loader.show(0)
  expect(loader.still?.image).toBe(asked[0])
  expect(addresses(asked.slice(before))).not.toContain('/0')
})

test('a frame that could not be fetched is asked for again', () => {
  const { loader, asked } = loading()
  loader.show(5)
  asked[0]!.onerror()
  loader.show(5)
  expect(addresses(asked).filter(address => address === '/5')).toHaveLength(2)
})
