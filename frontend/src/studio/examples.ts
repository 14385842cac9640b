const photos = import.meta.glob<string>('../../../examples/*.jpg', { query: '?url', import: 'default', eager: true })
const strokes = import.meta.glob<string>('../../../examples/*.strokes.json', {
  query: '?url',
  import: 'default',
  eager: true,
})

/** A bundled photo with its strokes; `name` is that of its files. */
export interface Example {
  readonly name: string
  readonly photo: string
  readonly strokes: string
}

export const EXAMPLES: readonly Example[] = Object.entries(photos).map(([path, photo]) => {
  const stem = path.replace(/\.jpg$/, '')
  return { name: stem.split('/').at(-1)!, photo, strokes: strokes[`${stem}.strokes.json`]! }
})
