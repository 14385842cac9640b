import { bytes, percent } from './numbers'

/** What is said around the drawing: the start, the header, the gallery, notices and faults. */
export const welcomeText = {
  app: 'treestroke',
  close: 'Close',
  welcome: {
    /** By phrases: lines end between them. */
    title: ['One photo,', 'two strokes,', 'a whole tree'],
    /** `{leaves}` and `{trunk}` are underlined in the colours of the two strokes. */
    lead: 'Draw a loose line {leaves} and one {trunk}. treestroke finds the branches and grows the tree in 3D.',
    leadStrokes: { leaves: 'around the leaves', trunk: 'up the trunk' },
    choose: 'Choose a photo',
    otherWays: 'Or drop it on the page, or paste it. Many photos of one tree: drop them all.',
    formats: 'JPEG, PNG, WebP, HEIC, AVIF or TIFF, or a .treestroke project. Your files stay on this server.',
    illustration: 'A tree with a line around its leaves and a line up its trunk',
    examples: 'Or start with an example',
    examplesHint: {
      mouse: 'The strokes are already drawn. Click one to grow its tree.',
      touch: 'The strokes are already drawn. Tap one to grow its tree.',
    },
    credit: (author: string, licence: string) => `${author}, ${licence}`,
    drafts: 'Your drawings',
    draftsHint: 'Saved in this browser as you left them.',
    deleteDraft: (name: string) => `Delete “${name}”`,
    draftDeleted: (name: string) => `“${name}” is deleted.`,
    undo: 'Undo',
    grown: 'Trees you have grown',
    drop: 'Drop to open',
    unknownFile: 'This file cannot be opened. Drop a photo, a video, a drawing or a .treestroke project.',
    pasted: 'Pasted photo',
    opening: 'Opening …',
  },
  header: {
    home: 'treestroke: back to the start',
    name: 'Name of the drawing',
    untitled: 'Untitled tree',
    menu: 'Menu',
    newPhoto: 'New photo',
    open: 'Open',
    save: 'Save project',
    gallery: 'Gallery',
    shortcuts: 'Shortcuts',
    skip: 'Skip to the content',
    saved: (name: string) => `Saved as ${name}.`,
    title: (name: string) => `${name} – treestroke`,
    growing: (share: number, name: string) => `${percent(share)} – ${name}`,
    leave: 'This drawing could not be saved in the browser. Leave and lose it?',
  },
  examples: {
    burr_oak_dusk: 'Bur oak at dusk',
    oak_02: 'Young oak',
    osage_orange_autumn: 'Osage orange',
    sugar_maple_autumn: 'Sugar maple in autumn',
    orange: 'Orange tree',
    pear: 'Pear tree',
    pine: 'Pine',
    vine: 'Vine',
    young_ash: 'Young ash',
    imagined: 'Imagined tree',
  } as Readonly<Record<string, string>>,
  /** Author and licence of the examples. */
  credits: {
    burr_oak_dusk: ['Heath Cajandig', 'CC BY 2.0'],
    oak_02: ['Daniel Greenheck', 'MIT'],
    osage_orange_autumn: ['Daderot', 'public domain'],
    sugar_maple_autumn: ['James St. John', 'CC BY 2.0'],
  } as Readonly<Record<string, readonly [string, string]>>,
  gallery: {
    title: 'Your trees',
    unnamed: 'Unnamed tree',
    loading: 'Loading your trees …',
    empty: 'No trees yet. Draw two strokes on a photo, then press Grow. Your trees are saved here.',
    more: 'Show more',
    again: 'Try again',
    open: (name: string) => `Open ${name}`,
    rename: (name: string) => `Rename ${name}`,
    name: 'Name',
    download: (name: string) => `Download ${name}`,
    remove: (name: string) => `Delete ${name}`,
    removed: (name: string) => `${name} is deleted.`,
    restored: (name: string) => `${name} is back.`,
    undo: 'Undo',
    status: { queued: 'In the queue', failed: 'Failed', canceled: 'Canceled' },
    growing: (share: number) => `Growing · ${percent(share)}`,
    justNow: 'just now',
  },
  notices: {
    close: 'Close this message',
  },
  faults: {
    unreachable: 'The service does not answer. Your drawing is safe. Try again in a moment.',
    modelGone: 'This tree is no longer there: it was deleted. Grow it again from its strokes.',
    draftGone: 'This drawing is no longer saved in this browser.',
    projectIncomplete: 'This project has no photo or video, or no strokes. Save it again where you made it.',
    projectUnreadable: 'This project file is damaged. Save it again where you made it.',
    sketchUnreadable:
      'This drawing cannot be read. Save it as a PNG: dark strokes on white, a closed red line for the crown.',
    fileTooLarge: (size: number, most: number) =>
      `This file has ${bytes(size)}, but at most ${bytes(most)} are allowed. Make the picture smaller.`,
    /** In place of the service's own words, by its codes. */
    codes: {
      trunk_outside_crown: 'The trunk does not reach the crown. Draw it from the ground up into the leaves.',
      crown_too_small: 'The crown is too small. Draw it around all of the leaves.',
      trunk_level:
        'The trunk does not go up. Draw it from the ground upward; if the tree lies on its side, turn the photo first.',
      stroke_too_short: 'This stroke is too short. Draw it longer.',
      too_many_strokes: 'There are too many strokes. Delete some.',
      scale_unlikely: 'The measured line makes the tree impossibly large or small. Check its length and its ends.',
    },
    /** What is wrong with one's own picture of a leaf or a fruit. */
    ownPicture: {
      notPng: 'This is not a PNG. Choose a PNG with a transparent background.',
      unreadable: 'This picture is damaged. Save it again as a PNG.',
      opaque: 'This picture has no transparent background. Cut out what it shows.',
      empty: 'This picture is fully transparent. Choose one that shows something.',
    },
  },
} as const
