import { expect, test } from 'vitest'
import { isCompressed, readGlb } from '../../src/preview/glb'

/** A GLB with nothing but its JSON. */
function glb(head: object): ArrayBuffer {
  const json = new TextEncoder().encode(JSON.stringify({ asset: { version: '2.0' }, ...head }))
  const length = Math.ceil(json.length / 4) * 4
  const file = new Uint8Array(20 + length).fill(32)
  const view = new DataView(file.buffer)
  for (const [at, word] of [0x46546c67, 2, file.length, length, 0x4e4f534a].entries())
    view.setUint32(at * 4, word, true)
  file.set(json, 20)
  return file.buffer
}

test('a compressed file is recognized by its JSON', () => {
  expect(isCompressed(glb({ extensionsRequired: ['EXT_meshopt_compression'] }))).toBe(true)
  expect(isCompressed(glb({ extensionsRequired: ['KHR_meshopt_compression'] }))).toBe(true)
  expect(isCompressed(glb({ scenes: [] }))).toBe(false)
  expect(isCompressed(new ArrayBuffer(4))).toBe(false)
})

test('a file is read with what its scene says of the photo', async () => {
  const photo = { width: 4 }
  const { scene } = await readGlb(glb({ scene: 0, scenes: [{ extras: { photo } }] }))
  expect(scene.userData).toMatchObject({ photo })
})
