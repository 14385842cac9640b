/** What is said of how well a tree turned out, and of what was measured on it. */
export const scoreText = {
  details: 'Details',
  title: 'How well it turned out',
  match: (percent: string) => `${percent} match with the foliage and branches`,
  doubtful: (percent: string) => `${percent} match, but the photo was hard to read`,
  /** Of a sketched tree. */
  sketchMatch: (front: string) => `${front} of the front strokes are in the tree`,
  sketchesMatch: (front: string, side: string) =>
    front === side
      ? `${front} of the strokes of both sides are in the tree`
      : `${front} of the front strokes and ${side} of the side strokes are in the tree`,
  /** What makes the reading of a photo doubtful, by the service's codes. */
  doubts: {
    outside_photo: 'Strokes lie outside the photo.',
    crown_unclear: 'The crown looks much like what is around it.',
    trunk_unclear: 'No trunk is seen under the trunk line.',
    kind_unsure: 'It is unclear whether the tree has leaves. Choose Foliage in Settings.',
  } as Readonly<Record<string, string>>,
  /** By the least silhouette fit that each needs, the best first. */
  words: [
    [0.9, 'A very close match.'],
    [0.8, 'A good match.'],
    [0.65, 'A fair match. A few more branch strokes would help.'],
    [0, 'A loose match. Draw the crown closer and add branches.'],
  ] as readonly (readonly [number, string])[],
  /** By the least share of strokes that each needs, the best first. */
  sketchWords: [
    [0.98, 'The tree follows your strokes.'],
    [0.9, 'The tree follows nearly all of your strokes.'],
    [0, 'Some strokes are missing. Begin each branch on its parent branch.'],
  ] as readonly (readonly [number, string])[],
  rows: {
    frontCovered: ['Front strokes covered', 'How many of them the tree covers, seen from the front.'],
    sideCovered: ['Side strokes covered', 'How many of them the tree covers, seen from its left.'],
    frontTrue: ['Drawn on the front', 'How much of its main branches you drew there.'],
    sideTrue: ['Drawn on the side', 'How much of its main branches you drew there.'],
    paired: ['Found on both sheets', 'Front branches that match a branch of the side.'],
    inPlanes: ['Flat branches', 'Main branches that lie flat in a sheet. Fewer is better.'],
    silhouette: ['Silhouette', 'How much of the outline agrees with the photo or the sketch.'],
    reached: ['Leaves reached', 'How many leafy places of the photo a twig reaches.'],
    depth: ['Depth', 'Depth over width: near 1 for a tree that stands alone.'],
    branches: ['Branches', 'All of them, down to the finest twigs.'],
    leaves: ['Leaves', 'Or tufts of needles.'],
    triangles: ['Triangles', 'What a game or a renderer has to draw.'],
    size: ['File size', 'Of the GLB, textures included.'],
    time: ['Time', 'How long the service worked on the tree.'],
  },
  triangles: (count: string) => `${count} triangles`,
  times: (factor: string) => `${factor} ×`,
  measures: {
    title: 'Measures',
    lead: 'For exact measures, use Measure on something of known length.',
    unknown: 'Not known',
    quantity: (number: string, unit: string) => `${number} ${unit}`,
    range: (low: string, high: string, unit: string) => `${low} to ${high} ${unit}`,
    perPixel: (length: string) => `${length} per pixel`,
    /** By the service's names; one that is missing here shows the service's own words. */
    known: {
      height: ['Height', 'From the ground to the highest leaf.'],
      crown_width: ['Crown width', 'From left to right in the photo.'],
      crown_depth: ['Crown depth', 'From front to back.'],
      trunk_diameter: ['Trunk', 'Its thickness at breast height.'],
      crown_volume: ['Crown volume', 'The space that the crown fills.'],
      leaf_area: ['Leaf area', 'One side of all leaves.'],
      branches_by_order: ['Branches by order', 'The trunk, then its branches, then theirs, and so on.'],
      scale: ['Scale', 'How long one pixel of the photo is at the tree.'],
    } as Readonly<Record<string, readonly [label: string, why: string]>>,
    /** How sure a value is. */
    basis: {
      given: ['given', 'You gave this value.'],
      measured: ['measured', 'Measured in the photo.'],
      derived: ['derived', 'Calculated from branches that the photo does not show.'],
      assumed: ['assumed', 'Typical of such trees.'],
    } as Readonly<Record<string, readonly [word: string, meaning: string]>>,
  },
} as const
