import { metres, whole } from './numbers'
import { plural } from './plural'

function photos(count: number): string {
  return plural(count, { one: '# photo', other: '# photos' })
}

/** Texts about many photos of one tree. */
export const captureText = {
  /** The dialog that says what becomes of several photos. */
  offer: {
    title: (count: number) => `${photos(count)} of one tree?`,
    what: 'The tree is measured from all sides: where each photo was taken, its crown and its limbs.',
    how: 'First the photos are sent to this server, then the cameras are found. That takes a few minutes; you can draw meanwhile.',
    start: (count: number) => `Make one tree of ${photos(count)}`,
    add: (count: number) => `Add ${photos(count)} to this tree`,
    one: 'Or make the tree of one photo alone: choose it.',
    openOne: (name: string) => `Open ${name} alone`,
    tooFew: (count: number, least: number) =>
      `${whole(count)} photos are too few to measure a tree: at least ${whole(least)} are needed, and about 20 are best. Choose more at once, or go on with one of them.`,
    tooMany: (count: number, most: number) =>
      `These are ${photos(count)}; at most ${whole(most)} are read. Choose the sharpest ones all around the tree.`,
    others: (names: readonly string[]) => {
      const [first, ...more] = names
      return more.length
        ? `“${first}” and ${plural(more.length, { one: '# other file', other: '# other files' })} are no photos and are left out.`
        : `“${first}” is no photo and is left out.`
    },
    drop: 'Drop the photos of one tree',
  },
  /** The line above the strip of photos. */
  status: {
    lost: 'The service no longer has these photos. Choose them again: your strokes are kept.',
    sending: (place: number, count: number) => `Sending photo ${whole(place)} of ${whole(count)}`,
    missing: (have: number, count: number) =>
      `${whole(have)} of ${photos(count)} arrived. Choose the photos again to send the others.`,
    tooFew: (have: number, least: number) =>
      `${plural(have, { one: '# photo is here', other: '# photos are here' })}, at least ${whole(least)} are needed.`,
    unsolved: 'It is not known yet where the photos were taken.',
    queued: 'Finding the cameras begins soon.',
    ahead: (count: number) =>
      plural(count, { one: '# task is ahead in the queue.', other: '# tasks are ahead in the queue.' }),
    phases: {
      decode: 'Reading the photos',
      solve: 'Finding where the photos were taken',
    } as Readonly<Record<string, string>>,
    allUsed: (count: number) => `All ${photos(count)} are used.`,
    used: (used: number, count: number) => `${whole(used)} of ${photos(count)} are used.`,
    progress: 'Finding the cameras',
    sendingProgress: 'Sending the photos',
    chooseAgain: 'Choose the photos',
    goOn: 'Go on without them',
    more: 'Add photos',
    solve: 'Find the cameras',
    again: 'Try again',
    cancel: 'Cancel',
    advice: 'How to photograph a tree',
  },
  strip: {
    label: 'Photos of the tree',
    photo: (place: number, count: number, name: string) => `Photo ${whole(place)} of ${whole(count)}, ${name}`,
    drawn: 'with strokes',
    used: 'used',
    unused: 'not used',
    pending: 'not yet measured',
    /** Why a photo is not used, by the service's codes. */
    reasons: {
      same_photo: 'It shows the same as another photo.',
      blurred: 'It is less sharp than the others.',
      no_overlap: 'It shows too little of what the other photos show.',
      other_group: 'It fits some of the photos, but these do not fit the others.',
      other_tree: 'It looks past the tree that was drawn.',
    } as Readonly<Record<string, string>>,
    notUsed: (name: string, why: string) => `${name} is not used. ${why}`,
  },
  /** The distance between two photos. */
  distance: {
    open: 'Distance of two photos',
    why: 'How far apart were two photos taken? It sets the tree’s size.',
    from: 'From photo',
    to: 'to photo',
    metres: 'metres',
    set: 'Set',
    remove: 'Remove',
    same: 'Choose two different photos.',
    wrong: 'Enter a distance of more than 0 metres.',
    now: (from: string, to: string, length: number) => `${from} to ${to}: ${metres(length)}`,
  },
  refused: (name: string, why: string) => `${name} is left out. ${why}`,
  /** At a stroke over one photo of many. */
  on: (stroke: string, photo: string) => `${stroke} (${photo})`,
  tracing: (count: number) => `Reading the tree in ${photos(count)} …`,
  edited: 'The branches were edited.',
  scaled: 'The tree’s size is set by the distance of two photos.',
  hints: {
    waiting: 'Your strokes are enough. The tree takes shape once the cameras are found.',
    unsolved: 'Your strokes are enough. Now let the cameras be found.',
    reading: 'The tree is being read in all photos …',
    refine: 'Look at the other photos: draw where the tree is not found well, or grow it.',
    crownMissing: 'Strokes in this photo count once there is a line around its leaves, too.',
    notUsed: 'This photo is not used. Draw on another one.',
    show: 'Show the photo',
  },
  welcome: {
    title: 'Or measure it: many photos, one tree',
    hint: 'About 20 photos from all around it, and its crown and limbs are measured instead of guessed.',
    choose: 'Choose many photos',
    folder: 'Choose a folder',
    advice: 'How to photograph a tree',
    example: (count: number) => photos(count),
  },
  advice: {
    title: 'How to photograph a tree',
    lead: 'Walk around the tree once and take a photo every few steps.',
    ring: 'A plan of a tree with 20 places around it from which photos are taken',
    points: [
      ['All around', 'About 20 photos, one every 15 to 20 degrees. From half a circle the far side is guessed.'],
      ['Overlap', 'At least two thirds of what a photo shows should be in the next one, too.'],
      ['Far enough', 'The whole tree is in each photo, from the ground to its top, with ground and things around it.'],
      ['Move your feet', 'Photos taken from one place, only turned, say nothing about depth.'],
      ['Even light', 'A bright overcast day is best. Do not photograph against the sun.'],
      ['No wind', 'What moves between two photos cannot be measured.'],
      ['One lens', 'Keep the zoom as it is, and do not edit or crop the photos.'],
    ] as readonly (readonly [string, string])[],
    least: (least: number, most: number) =>
      `At least ${whole(least)} photos are needed, and ${whole(most)} are read at most.`,
  },
} as const
