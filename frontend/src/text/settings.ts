/** What is said of a setting. */
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
    leaves: 'What a photo cannot show of leaves and bark.',
    file: 'What you get with the tree. The branches stay the same.',
  } as Readonly<Record<string, string>>,
  fileAgain: 'Grow again to make these files. The tree stays the same.',
  seed: 'Seed',
  seedWhy: 'The same seed gives the same tree. Another seed gives another tree.',
  heightMeasured: (length: string) => `The measured line (${length}) sets the tree’s size instead.`,
  heightByDistance: (length: string) => `The distance of two photos (${length}) sets the tree’s size instead.`,
  range: (low: string, high: string) => `Enter a number from ${low} to ${high}.`,
  wholeRange: (low: string, high: string) => `Enter a whole number from ${low} to ${high}.`,
  ownPictures: {
    replace: 'Replace',
    remove: 'Remove',
    leaf: {
      label: 'Your own leaf',
      why: 'One leaf, stalk down, as a PNG with a transparent background.',
      choose: 'Choose a picture',
      shown: 'Your leaf',
      added: 'Your leaf is added.',
      removed: 'Your leaf is removed.',
    },
    fruit: {
      label: 'Your own fruit',
      why: 'One fruit, stalk up, as a PNG with a transparent background.',
      choose: 'Choose a fruit',
      shown: 'Your fruit',
      added: 'Your fruit is added.',
      removed: 'Your fruit is removed.',
    },
  },
  /** By the service's names; one that is missing here shows the service's own words. */
  known: {
    height: {
      label: 'Height',
      unit: 'm',
      why: 'From the ground to the highest leaf. Sets the file’s scale.',
    },
    library: {
      label: 'Branch patterns',
      why: 'How branches divide inside the crown.',
      names: {
        auto: 'Choose for me',
        visible: 'As in the photo',
        type1: 'Forks at the tips',
        type2: 'Side shoots along the branch',
        both: 'Forks and side shoots',
      },
    },
    iterations: {
      label: 'Growth',
      unit: 'rounds',
      why: 'More rounds give finer twigs. 0 keeps only what the photo shows.',
    },
    variants: {
      label: 'Trees',
      unit: 'trees',
      why: 'How many different trees to grow. Each needs the same time.',
    },
    form: {
      label: 'Form',
      why: 'How limbs grow where the photo shows none.',
      names: {
        auto: 'As in the photo',
        round: 'Round',
        spire: 'Spire (fir)',
        columnar: 'Column (poplar)',
        umbrella: 'Umbrella (acacia)',
        weeping: 'Weeping (willow)',
        vase: 'Vase (elm)',
        multi_stem: 'Several stems',
      },
    },
    species: {
      label: 'Species',
      why: 'Sets the shape and arrangement of the leaves, and the bark.',
      names: {
        auto: 'Not specified',
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
    siblings: {
      label: 'Siblings',
      why: 'How many other trees of the same kind are made. The panel Siblings has more.',
    },
    grove: { label: 'Grove', why: 'One more file with the tree and its siblings beside each other.' },
    lift: {
      label: 'Depth',
      why: 'How the depth of branches is found that one picture shows.',
      names: { auto: 'As measured best', spread: 'Spread evenly', posterior: 'By probability' },
    },
    season: {
      label: 'Season',
      why: 'Colours and thins the leaves, whatever season the photo shows.',
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
      why: 'What grows on the twigs. The photo may be misread.',
      names: {
        auto: 'As in the photo',
        leaves: 'Leaves',
        needles: 'Needles',
        scales: 'Scales (cypress, juniper)',
        palm: 'Palm',
        bare: 'Bare',
      },
    },
    edge: {
      label: 'At the photo’s edge',
      why: 'What to do with a crown that the photo cuts off.',
      names: { complete: 'Complete the crown', cut: 'End the tree there' },
    },
    light: {
      label: 'Light',
      why: 'Light and shade of the leaves. Very dark photos are brightened.',
      names: { photo: 'As in the photo', even: 'Even: without sun and shade' },
    },
    leaf_size: { label: 'Leaf size', unit: '×', why: '1 is the size that suits the tree.' },
    leaf_density: {
      label: 'Leaf density',
      unit: '×',
      why: '1 is as in the photo. 0 leaves the twigs bare.',
    },
    wind: {
      label: 'Wind',
      why: 'Animations in the file that move the tree. They also play here.',
      names: { none: 'No wind', breeze: 'A breeze', all: 'A breeze and a gust' },
    },
    lod: {
      label: 'Levels of detail',
      why: 'Lighter versions of the tree, to be seen from far away.',
      names: { none: 'Only the full tree', files: 'Each in its own file', one: 'All in one file' },
    },
    compress: {
      label: 'Compress the GLB',
      why: 'A third of the size. Some programs cannot read meshopt or WebP.',
    },
    files: {
      label: 'More formats',
      why: 'Files of the same tree in addition to the GLB.',
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
