import { readFileSync } from 'node:fs'
import { strToU8, zipSync } from 'fflate'
import { expect, test } from 'vitest'
import { DEFAULT_SETTINGS } from '../../src/api/defaults'
import { NO_STROKES, withEdit, withPhoto, withSheet } from '../../src/strokes'
import { isProject, projectName, readProject, writeProject } from '../../src/studio/project'
import { CROWN, LIMB, TRUNK } from '../builders'

const STROKES = {
  crown: CROWN,
  branches: [{ points: TRUNK, width: 7 }, { points: LIMB }],
  erase: [LIMB],
  scale: { points: TRUNK, metres: 1.8 },
}
const jpeg = new Blob([readFileSync(new URL('../../../examples/osage_orange_autumn.jpg', import.meta.url))], {
  type: 'image/jpeg',
})

const opened = (file: Blob) =>
  readProject(file, () => Promise.reject(new Error('this project has no picture of a sketch')))

function zip(members: Record<string, string>): Blob {
  return new Blob([zipSync(Object.fromEntries(Object.entries(members).map(([name, held]) => [name, strToU8(held)])))])
}

test('a project is read as it was written', async () => {
  const project = { photo: jpeg, strokes: STROKES, settings: { ...DEFAULT_SETTINGS, height: 14 }, seed: 8, leaf: null }
  const read = await opened(await writeProject(project))
  expect({ ...read, photo: null }).toEqual({ fruit: null, sizes: {}, ...project, photo: null })
  expect(read.photo?.type).toBe('image/jpeg')
  expect(Buffer.from(await read.photo!.arrayBuffer()).equals(Buffer.from(await jpeg.arrayBuffer()))).toBe(true)
})

test.each(['image/heic', 'image/avif', 'image/tiff'])('a photo of type %s keeps its type', async type => {
  const photo = new Blob(['dots'], { type })
  const written = await writeProject({ photo, strokes: STROKES, settings: DEFAULT_SETTINGS, seed: 0, leaf: null })
  expect((await opened(written)).photo?.type).toBe(type)
})

test('a project without a crown is written and read, too', async () => {
  const strokes = { crown: null, branches: [{ points: TRUNK }], erase: [], scale: null }
  const read = await opened(
    await writeProject({ photo: jpeg, strokes, settings: DEFAULT_SETTINGS, seed: 0, leaf: null }),
  )
  expect(read.strokes).toEqual(strokes)
})

test('settings may be absent', async () => {
  const strokes = JSON.stringify({ crown: { points: CROWN } })
  const read = await opened(zip({ 'photo.png': 'x', 'strokes.json': strokes }))
  expect([read.settings, read.seed, read.photo?.type]).toEqual([DEFAULT_SETTINGS, 0, 'image/png'])
})

test.each([
  ['no ZIP', new Blob(['hello']), 'damaged'],
  ['no photo', zip({ 'strokes.json': '{}' }), 'no photo'],
  ['strokes of another form', zip({ 'photo.jpg': 'x', 'strokes.json': '{"crown": 7}' }), 'damaged'],
  ['views of another form', zip({ 'photos/0.jpg.png': 'x', 'views.json': '{}' }), 'damaged'],
  ['edits of another form', zip({ 'views.json': '{"views": []}', 'edits.json': '{}' }), 'damaged'],
  ['no JSON', zip({ 'photo.jpg': 'x', 'strokes.json': '{' }), 'damaged'],
])('%s is said in a sentence', async (_, file, word) => {
  await expect(opened(file)).rejects.toThrow(word)
})

test('a project of many photos is read as it was written, with its edits', async () => {
  const strokes = withEdit(withPhoto(NO_STROKES, 'b.jpg', STROKES), { do: 'remove', at: [0, 1, 2] })
  const photos = ['a.png', 'b.jpg'].map(name => new File(['dots'], name, { type: 'image/png' }))
  const written = await writeProject({ photo: null, photos, strokes, settings: DEFAULT_SETTINGS, seed: 3, leaf: null })
  const read = await opened(written)
  expect(read.photos?.map(({ name, type }) => [name, type])).toEqual([
    ['a.png', 'image/png'],
    ['b.jpg', 'image/png'],
  ])
  expect(read.strokes).toEqual(strokes)
  expect(read.seed).toBe(3)
})

test('a project is recognized by its ending or its type', () => {
  expect(isProject(new File([], 'oak.treestroke'))).toBe(true)
  expect(isProject(new File([], 'oak.zip', { type: 'application/zip' }))).toBe(true)
  expect(isProject(new File([], 'oak.jpg', { type: 'image/jpeg' }))).toBe(false)
})

test('a name becomes a file name that every system accepts', () => {
  expect(projectName('Oak: 3/4 "view"')).toBe('Oak_ 3_4 _view_.treestroke')
  expect(projectName('')).toBe('tree.treestroke')
})

test('a project holds an own picture of a leaf', async () => {
  const leaf = new Blob(['a leaf'], { type: 'image/png' })
  const project = { photo: jpeg, strokes: STROKES, settings: DEFAULT_SETTINGS, seed: 0, leaf }
  const read = await opened(await writeProject(project))
  expect([await read.leaf?.text(), read.leaf?.type]).toEqual(['a leaf', 'image/png'])
})

test('sketches on paper are read as they were written, with a fruit and without a photo', async () => {
  const front = { ...NO_STROKES, crown: CROWN, branches: [{ points: TRUNK, width: 7 }] }
  const strokes = withSheet(front, 'side', { ...NO_STROKES, branches: [{ points: LIMB }] })
  const sizes = { front: { width: 900, height: 1200 }, side: { width: 450, height: 600 } }
  const written = { photo: null, strokes, sizes, settings: DEFAULT_SETTINGS, seed: 2, leaf: null }
  const read = await opened(await writeProject({ ...written, fruit: new Blob(['a pear']) }))
  expect(read).toMatchObject(written)
  expect(await read.fruit?.text()).toBe('a pear')
})

test('a side beside a photo’s strokes is written and read with them', async () => {
  const strokes = withSheet(STROKES, 'side', { ...NO_STROKES, branches: [{ points: LIMB }] })
  const sizes = { side: { width: 450, height: 600 } }
  const project = { photo: jpeg, strokes, sizes, settings: DEFAULT_SETTINGS, seed: 0, leaf: null }
  const read = await opened(await writeProject(project))
  expect([read.strokes, read.sizes]).toEqual([strokes, sizes])
  expect(read.photo?.size).toBe(jpeg.size)
})

test('a sketch that is a picture is read as strokes, with its corrections', async () => {
  const picture = zip({ 'front.png': 'ahead', 'side.png': 'left', 'settings.json': '{"height": 6}' })
  const size = { width: 450, height: 600 }
  const ways = { ahead: TRUNK, left: LIMB } as Readonly<Record<string, typeof TRUNK>>
  const project = await readProject(picture, async file => {
    const [held, strokes] = [await file.text(), { ...NO_STROKES }]
    const branches = [{ points: ways[held]!, width: 7 }]
    return { strokes: { ...strokes, branches }, size, ...(held === 'left' && { corrections: '1 gap was closed.' }) }
  })
  expect(project).toMatchObject({ sizes: { front: size, side: size }, corrections: 'Left side: 1 gap was closed.' })
  expect(project.strokes.branches).toEqual([{ points: TRUNK, width: 7 }])
  expect(project.strokes.side?.branches).toEqual([{ points: LIMB, width: 7 }])
})
