import { sheetsText } from './sheets'

/** What is said of how well a tree turned out, and of what was measured on it. */
export const scoreText = {
  details: 'Details',
  title: 'How well it turned out',
  match: (percent: string) => `${percent} match with the foliage and branches as they were read`,
  doubtful: (percent: string) => `${percent} match with a reading that is in doubt`,
  /** What makes the reading of a photo doubtful, by the service's codes. */
  doubts: {
    trunk_level: 'The trunk’s stroke lies level or runs down.',
    outside_photo: 'Strokes lie outside the photo.',
    crown_unclear: 'Inside the crown it looks as around it.',
    kind_unsure: 'It is hard to see whether it bears leaves: choose Leaves or Bare for Foliage in the settings.',
  } as Readonly<Record<string, string>>,
  /** By the least silhouette fit that each needs, the best first. */
  words: [
    [0.9, 'A very close likeness.'],
    [0.8, 'A good likeness.'],
    [0.65, 'A fair likeness; a few more branch strokes would help.'],
    [0, 'A loose likeness; draw the crown closer and add a few branches.'],
  ] as readonly (readonly [number, string])[],
  rows: {
    ...sheetsText.score.rows,
    silhouette: [
      'Silhouette',
      'How much of its outline agrees with what was read in the photo, or with the crown in the sketch.',
    ],
    reached: ['Leaves reached', 'Leafy places of the photo that a twig grew to.'],
    depth: ['Depth', 'As deep as wide is 1, which is usual for a tree that stands free.'],
    branches: ['Branches', 'All of them, down to the finest twigs.'],
    leaves: ['Leaves', 'Or tufts of needles.'],
    triangles: ['Triangles', 'What a game or a renderer has to draw.'],
    size: ['File size', 'Of the GLB, textures included.'],
    time: ['Grown in', 'The time that the service took.'],
  },
  triangles: (count: string) => `${count} triangles`,
  seconds: (seconds: string) => `${seconds} s`,
  times: (factor: string) => `${factor} ×`,
  measures: {
    title: 'Measures',
    lead: 'They are as sure as the scale is: draw a line with Measure over something whose length you know.',
    unknown: 'Not known',
    range: (low: string, high: string) => `${low} to ${high}`,
    /** By the service's names; one that is missing here shows the service's own words. */
    known: {
      height: ['Height', 'From the foot of the trunk to the highest leaf.'],
      crown_width: ['Crown width', 'From left to right in the photo.'],
      crown_depth: ['Crown depth', 'From front to back, which no photo shows.'],
      trunk_diameter: ['Trunk', 'Its thickness at breast height.'],
      crown_volume: ['Crown volume', 'The room that the crown takes.'],
      leaf_area: ['Leaf area', 'One side of all leaves.'],
      branches_by_order: ['Branches by order', 'Trunk first, then what leaves it, and so on outward.'],
      scale: ['Scale', 'What one pixel of the photo is at the tree.'],
    } as Readonly<Record<string, readonly [label: string, why: string]>>,
    /** How sure a value is. */
    basis: {
      given: ['given', 'As you said it.'],
      measured: ['measured', 'Seen in the photo.'],
      derived: ['derived', 'Follows from what was grown where the photo shows nothing.'],
      assumed: ['assumed', 'Taken as it is with such trees.'],
    } as Readonly<Record<string, readonly [word: string, meaning: string]>>,
    perPixel: 'per pixel',
  },
} as const
