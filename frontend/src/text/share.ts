import { bytes, metres } from './numbers'

/** What is said on the page of a shared tree. */
export const sharePageText = {
  app: 'treestroke',
  unnamed: 'A tree',
  title: (name: string) => `${name} – treestroke`,
  loading: 'Loading the tree …',
  canvas: 'The tree in 3D. Arrow keys turn it, plus and minus zoom.',
  wipe: 'Between the photo and the tree',
  picture: (name: string) => `Picture of ${name}`,
  photo: 'The photo that it was made of',
  download: (size: number) => `Download GLB · ${bytes(size)}`,
  embed: 'Embed',
  embedHint: 'Put this into a page of yours:',
  copy: 'Copy',
  copied: 'Copied',
  open: 'Open',
  noWebgl: 'This browser shows no 3D. Here is a picture of the tree.',
  height: (high: number) => `${metres(high)} high`,
  missing: 'This link leads nowhere. Ask who sent it to you for another one.',
  over: 'This link has ended. Ask who sent it to you for another one.',
  unreachable: 'The tree cannot be loaded at the moment. Try again in a while.',
  again: 'Try again',
} as const
