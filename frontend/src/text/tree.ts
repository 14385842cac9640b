import { duration, percent } from './numbers'
import { plural } from './plural'

/** What is said beside the tree: its preview, and how it is grown. */
export const treeText = {
  grow: {
    grow: 'Grow',
    growing: 'Growing …',
    again: 'Grow again',
    tryAgain: 'Try again',
    another: 'Another tree',
    anotherWhy: 'Grow a different tree from the same strokes',
    settings: 'Settings',
    cancel: 'Cancel',
    /** What the line above the Grow button says, by the growth status. */
    status: {
      noPhoto: 'Open a photo of a tree to begin.',
      noCrown: 'First draw one loose stroke around the crown.',
      noTrunk: 'Now draw a stroke up the trunk.',
      noFront: 'First draw the trunk on the front sheet.',
      badStroke: 'A stroke cannot be used. Change it, then grow the tree.',
      ready: 'Ready to grow bark, twigs and leaves.',
      asking: 'Sending the request',
      loading: 'Loading the tree',
      strokesChanged: 'The strokes have changed since this tree was grown.',
      settingsChanged: 'The settings have changed since this tree was grown.',
      filesChanged: 'Grow again to make the chosen files. The tree stays the same.',
      canceled: 'Growing was canceled. Your strokes are unchanged.',
      grown: 'The tree is grown.',
      failed: 'The tree could not be grown.',
    },
  },
  progress: {
    label: 'Growing the tree',
    phases: {
      decode: 'Reading the photo',
      foliage: 'Finding the leaves',
      trace: 'Tracing the branches',
      lift: 'Adding depth',
      grow: 'Growing branches',
      leaf: 'Adding leaves',
      mesh: 'Adding bark',
      levels: 'Making levels of detail',
      write: 'Writing the files',
      preview: 'Drawing a picture',
    } as Readonly<Record<string, string>>,
    starting: 'Starting',
    next: 'Next in the queue',
    queued: (ahead: number) =>
      plural(ahead, { one: '# tree is ahead in the queue', other: '# trees are ahead in the queue' }),
    attempt: (step: string, number: number) => `${step} (attempt ${number})`,
    percentAndTime: (share: number, seconds: number) => `${percent(share)} · about ${duration(seconds)} left`,
    offline: 'The connection is lost. It comes back by itself.',
    done: (match: string, judgement: string) => `The tree is grown. ${match}. ${judgement}`,
  },
  preview: {
    canvas: 'The tree in 3D. Drag or use the arrow keys to turn it, plus and minus to zoom.',
    wipe: 'Slide between photo and tree',
    empty: 'Your tree appears here once you draw its trunk',
    views: 'View',
    free: 'Free view',
    view: { photo: 'Photo', front: 'Front', side: 'Side', back: 'Back', top: 'Top' },
    /** The first view, where the front was drawn on bare paper. */
    drawing: 'Drawing',
    leaves: 'Leaves',
    nearer: 'Zoom in',
    farther: 'Zoom out',
    shows: 'What is shown',
    showing: {
      live: { long: 'Live skeleton', short: 'Live' },
      model: { long: 'Grown tree', short: 'Grown' },
    },
    wind: {
      group: 'Wind',
      names: { still: 'Still', breeze: 'Breeze', gust: 'Gust' } as Readonly<Record<string, string>>,
      add: 'Add wind',
      addHow: 'No wind yet. Choose it in Settings, File, then grow again.',
    },
    variants: {
      group: 'Tree',
      oneOf: (number: number, count: number) => `Tree ${number} of ${count}`,
    },
    assumed: 'Only the front is drawn. The depth is a guess.',
    absent: 'This browser shows no 3D. Turn on WebGL. Downloads still work.',
    lost: 'The 3D view was lost and is coming back.',
    unreadable: 'The tree cannot be shown here. Download it, or grow it again.',
    picture: 'The grown tree, from the front and from the side',
  },
} as const
