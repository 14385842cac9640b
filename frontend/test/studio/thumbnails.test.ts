import { afterEach, expect, test, vi } from 'vitest'
import { Client } from '../../src/api/client'
import { Thumbnails } from '../../src/studio/thumbnails'
import { capturePhoto } from '../builders'
import { service } from '../service'

afterEach(() => vi.unstubAllGlobals())

function begin(shrink = vi.fn(async () => new Blob(['small']))) {
  const calls = service(() => new Response('large'))
  const kept = new Map<string, Blob>()
  const drafts = {
    thumbnail: async (id: string) => kept.get(id) ?? null,
    keepThumbnail: async (id: string, picture: Blob) => void kept.set(id, picture),
  }
  return { calls, kept, shrink, thumbnails: new Thumbnails(new Client(), drafts, shrink) }
}

const PHOTO = capturePhoto('00.jpg')

test('a thumbnail is made once, of the file at hand, and kept', async () => {
  const { calls, kept, shrink, thumbnails } = begin()
  const file = new Blob(['a photo'])
  const [first, second] = await Promise.all([thumbnails.of(PHOTO, file), thumbnails.of(PHOTO)])
  expect(first).toBe(second)
  expect(shrink.mock.calls).toEqual([[file]])
  expect([calls.length, kept.size]).toEqual([0, 1])
})

test('without a file it is made of the service’s picture', async () => {
  const { calls, thumbnails } = begin()
  expect(await thumbnails.of(PHOTO)).toMatch(/^blob:/)
  expect(calls.map(({ path }) => path)).toEqual([PHOTO.image])
})

test('one that is kept is not made again', async () => {
  const { kept, shrink, thumbnails } = begin()
  kept.set(PHOTO.id, new Blob(['small']))
  await thumbnails.of(PHOTO)
  expect(shrink).not.toHaveBeenCalled()
})

test('a file that the browser cannot read is fetched as the service has it; else there is none', async () => {
  const shrink = vi.fn(async (picture: Blob) => {
    if ((await picture.text()) === 'heic') throw new Error('cannot be decoded')
    return picture
  })
  const { thumbnails } = begin(shrink as never)
  expect(await thumbnails.of(PHOTO, new Blob(['heic']))).toMatch(/^blob:/)
  const none = begin(vi.fn(async () => Promise.reject(new Error('cannot be decoded'))))
  expect(await none.thumbnails.of(PHOTO)).toBeNull()
})
