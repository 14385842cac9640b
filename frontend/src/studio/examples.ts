import type { Settings } from '../api/types'

const photos = import.meta.glob<string>('../../../examples/*.jpg', { query: '?url', import: 'default', eager: true })
const strokes = import.meta.glob<string>('../../../examples/*.strokes.json', {
  query: '?url',
  import: 'default',
  eager: true,
})

/** An example photo with its strokes, as addresses; `name` is that of its files. */
export interface Example {
  readonly name: string
  readonly photo: string
  readonly strokes: string
}

export const EXAMPLES: readonly Example[] = Object.entries(photos).map(([path, photo]) => {
  const stem = path.replace(/\.jpg$/, '')
  return { name: stem.split('/').at(-1)!, photo, strokes: strokes[`${stem}.strokes.json`]! }
})

const manyPhotos = import.meta.glob<string>('../../../examples/*/[0-9]*.jpg', {
  query: '?url',
  import: 'default',
  eager: true,
})
const manyStrokes = import.meta.glob<string>('../../../examples/*/strokes.json', {
  query: '?url',
  import: 'default',
  eager: true,
})

/** An example of many photos with the strokes over some of them; `name` is that of its folder. */
export interface PhotosExample {
  readonly name: string
  readonly photos: readonly { readonly name: string; readonly url: string }[]
  /** The address of the strokes. */
  readonly strokes: string
}

export const PHOTOS_EXAMPLES: readonly PhotosExample[] = Object.entries(manyStrokes).map(([path, strokes]) => {
  const folder = path.replace(/strokes\.json$/, '')
  const photos = Object.entries(manyPhotos)
    .filter(([photo]) => photo.startsWith(folder))
    .map(([photo, url]) => ({ name: photo.slice(folder.length), url }))
  return { name: folder.split('/').at(-2)!, photos, strokes }
})

const sketches = import.meta.glob<string>('../../../examples/sketches/*.{front,side}.{json,png}', {
  query: '?url',
  import: 'default',
  eager: true,
})
const pictures = import.meta.glob<string>('../../../examples/sketches/*.{leaf,fruit}.png', {
  query: '?url',
  import: 'default',
  eager: true,
})

const settings = import.meta.glob<Partial<Settings>>('../../../examples/sketches/*.settings.json', {
  import: 'default',
  eager: true,
})

/** An example of sketches (JSON or PNG), perhaps with a leaf and a fruit, as addresses; `name` is that of its files. */
export interface SketchExample {
  readonly name: string
  readonly front: string
  readonly side: string | undefined
  readonly leaf: string | undefined
  readonly fruit: string | undefined
  readonly settings: Partial<Settings>
}

export const SKETCH_EXAMPLES: readonly SketchExample[] = Object.entries(sketches)
  .filter(([path]) => path.includes('.front.'))
  .map(([path, front]) => {
    const stem = path.replace(/\.front\.\w+$/, '')
    return {
      name: stem.split('/').at(-1)!,
      front,
      side: sketches[path.replace('.front.', '.side.')],
      leaf: pictures[`${stem}.leaf.png`],
      fruit: pictures[`${stem}.fruit.png`],
      settings: settings[`${stem}.settings.json`] ?? {},
    }
  })
