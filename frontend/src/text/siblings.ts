import { whole } from './numbers'
import { plural } from './plural'

/** Texts about other trees of the same kind. */
export const siblingsText = {
  title: 'Siblings',
  lead: 'Other trees of the same kind, none a copy.',
  count: 'How many',
  seed: 'Seed',
  another: 'Another seed',
  outline: 'Outline to fill',
  outlines: {
    none: 'Its own',
    heart: 'Heart',
    triangle: 'Triangle',
    circle: 'Circle',
    pentagon: 'Pentagon',
    drawn: 'Drawn',
    picture: 'Picture',
  },
  pad: 'Draw an outline here, in one closed line',
  padHint: 'Draw a closed line. The dashed line is the ground.',
  padTooSmall: 'Draw a larger outline.',
  choosePicture: 'Choose a picture',
  pictureHint: 'Its dark shape, or what is not transparent, becomes the outline.',
  pictureUnreadable: 'No shape is found in this picture. Choose one with a dark shape on white.',
  grow: (count: number) => plural(count, { one: 'Grow # sibling', other: 'Grow # siblings' }),
  list: 'The tree and its siblings',
  own: 'The tree',
  one: (number: number) => `Sibling ${whole(number)}`,
  open: (name: string) => `Show ${name}`,
  download: (name: string) => `Download ${name} as GLB`,
  scene: 'Download the grove, GLB',
  grove: {
    title: 'Grove',
    open: 'Walk through a grove',
    label: 'A grove of the tree and its siblings. Drag or use the arrow keys to turn it, plus and minus to zoom.',
    count: 'Trees',
    loading: 'Planting the grove …',
    failed: 'The grove cannot be shown here. Its trees can be downloaded.',
    facts: (trees: number, calls: number, triangles: number) =>
      `${whole(trees)} trees, ${whole(calls)} draw calls, ${whole(triangles)} triangles`,
  },
} as const
