/** How a setting is spoken of. */
export interface SettingText {
  readonly label: string
  readonly unit?: string
  readonly why: string
  /** Of its choices. */
  readonly names?: Readonly<Record<string, string>>
}

/** What is said of the settings. */
export const settingsText = {
  title: 'How it grows',
  reset: 'Reset to defaults',
  groups: { tree: 'Tree', leaves: 'Leaves', file: 'File' } as Readonly<Record<string, string>>,
  groupsLabel: 'Settings of',
  /** What stands at the head of a group. */
  leads: {
    leaves: 'What one photo cannot tell of leaves and bark.',
    file: 'What you get with the tree. These change no branch: with the same seed the tree stays the same.',
  } as Readonly<Record<string, string>>,
  fileAgain: 'Press Grow to make these files: the tree stays the same.',
  seed: 'Seed',
  seedWhy: 'The same seed gives the same tree. Any other number gives another one.',
  heightMeasured: (length: string) =>
    `The measured line (${length}) sets how large the tree is, in place of the height.`,
  range: (low: string, high: string, whole: boolean) => `Give a ${whole ? 'whole ' : ''}number from ${low} to ${high}.`,
  leaf: {
    label: 'Leaf of your own',
    why: 'A PNG of one leaf with a transparent background, its stalk at the bottom. It takes the place of the leaves as they come.',
    choose: 'Choose a picture',
    replace: 'Replace',
    remove: 'Remove',
    shown: 'Your leaf',
    taken: 'Your leaf is taken.',
    removed: 'Your leaf is removed.',
  },
  /** By the service's names; one that is missing here shows the service's own words. */
  known: {
    height: {
      label: 'Height',
      unit: 'm',
      why: 'From the foot of the trunk to the highest leaf, in metres. It sets the scale of the file.',
    },
    library: {
      label: 'Branch patterns',
      why: 'How branches divide inside the crown.',
      names: {
        auto: 'Choose for me',
        visible: 'Those of the photo',
        type1: 'Forks at the tips',
        type2: 'Side shoots along the branch',
        both: 'Forks and side shoots',
      },
    },
    iterations: {
      label: 'Growth',
      unit: 'rounds',
      why: 'More rounds give finer twigs; 0 keeps only what is seen in the photo.',
    },
    variants: {
      label: 'Trees',
      unit: 'trees',
      why: 'So many different trees of the one photo, for a row or a wood. Each takes as long as the first.',
    },
    species: {
      label: 'Species',
      why: 'Gives the shape of the leaves, how they sit, and the relief of the bark.',
      names: {
        auto: 'Not said',
        ash: 'Ash',
        beech: 'Beech',
        birch: 'Birch',
        cherry: 'Cherry',
        elm: 'Elm',
        horse_chestnut: 'Horse chestnut',
        larch: 'Larch',
        linden: 'Linden (lime)',
        locust: 'Locust (robinia)',
        maple: 'Maple',
        oak: 'Oak',
        pine: 'Pine',
        plane: 'Plane (sycamore)',
        poplar: 'Poplar',
        spruce: 'Spruce',
        walnut: 'Walnut',
        willow: 'Willow',
      },
    },
    season: {
      label: 'Season',
      why: 'Colours the leaves and thins them out, whatever the photo’s own season.',
      names: {
        photo: 'As in the photo',
        spring: 'Spring: fresh and light',
        summer: 'Summer: full and green',
        autumn: 'Autumn: coloured, some fallen',
        bare: 'Winter: bare',
      },
    },
    foliage: {
      label: 'Foliage',
      why: 'What the twigs bear.',
      names: { auto: 'As in the photo', leaves: 'Leaves', needles: 'Needles', bare: 'Nothing (winter)' },
    },
    leaf_size: { label: 'Leaf size', unit: '×', why: '1 is the size that suits the tree.' },
    leaf_density: {
      label: 'Leaf density',
      unit: '×',
      why: '1 is as dense as in the photo; 0 leaves the twigs bare.',
    },
    wind: {
      label: 'Wind',
      why: 'Movements inside the file, as animations with bones; they can be played here, too.',
      names: { none: 'None', breeze: 'A breeze', all: 'A breeze and a gust' },
    },
    lod: {
      label: 'Levels of detail',
      why: 'Lighter trees for the distance, down to a picture on crossed cards.',
      names: { none: 'Only the full tree', files: 'Each in a file of its own', one: 'All in the one file' },
    },
    compress: {
      label: 'Compress the GLB',
      why: 'About a third of the size, for the web. Needs a reader of meshopt and WebP; some programs have none.',
    },
    files: {
      label: 'More formats',
      why: 'Files beside the GLB, all of the same tree.',
      names: {
        gltf: 'glTF',
        obj: 'Wavefront OBJ',
        usdz: 'USDZ (Apple)',
        ply: 'PLY',
        instanced: 'Leaf instances',
        collision: 'Collision shape',
        json: 'Skeleton, JSON',
        swc: 'Skeleton, SWC',
        csv: 'Skeleton, table',
      },
    },
  } as Readonly<Record<string, SettingText>>,
} as const
