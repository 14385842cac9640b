import { bytes, percent, whole } from './numbers'

const seconds = new Intl.NumberFormat('en', { maximumFractionDigits: 1 })

/** Texts about a video of one tree. */
export const clipText = {
  drop: 'Drop the video of a tree',
  /** The dialog that says what becomes of a video. */
  offer: {
    title: 'A video of one tree?',
    what: 'The tree is grown from one frame of the video, and sways as it does there.',
    how: 'The video is sent to this server. Then choose a frame, and draw a line around the leaves.',
    file: (name: string, size: number) => `${name}, ${bytes(size)}`,
    start: 'Use this video',
    other: 'Choose another video',
    sending: (share: number) => `Sending the video: ${percent(share)}`,
    reading: 'Reading the video …',
    offline: 'The connection is lost. Sending goes on by itself.',
    progress: 'Sending the video',
    cancel: 'Cancel',
    playing: 'The chosen video',
  },
  tooLarge: (size: number, most: number) =>
    `This video has ${bytes(size)}, but at most ${bytes(most)} are allowed. Cut out a few seconds, or save it smaller.`,
  givenUp: 'Sending the video was canceled.',
  /** The strip of frames below the sheet. */
  strip: {
    label: 'Frame that is drawn on',
    frame: (frame: number, frames: number, place: number) =>
      `Frame ${whole(frame + 1)} of ${whole(frames)}, at ${seconds.format(place)} seconds`,
    now: (frame: number, frames: number) => `Frame ${whole(frame + 1)} of ${whole(frames)}`,
    facts: (length: number, rate: number) => `${seconds.format(length)} s, ${seconds.format(rate)} frames a second`,
    draw: 'Draw',
    watch: 'Watch',
    modes: 'Draw on a frame, or watch the video',
    tracks: 'Tracks',
    tracksWhy: 'Show the points of the tree that were followed',
    lost: 'The service no longer has this video. Choose it again: your strokes are kept.',
    choose: 'Choose the video',
    tracked: (count: number) => `${whole(count)} points of the tree are followed.`,
  },
  screen: 'The video, with the points of the tree that were followed',
  /** In the tree's place, before there is one. */
  empty: 'Your tree appears here once you draw around its leaves',
  tracing: 'Following the tree through the video …',
  frameChosen: (frame: number) => `Frame ${whole(frame + 1)} is drawn on.`,
  hints: {
    crown: 'Draw a loose line around all of the leaves. Another frame may show them better.',
    trunk: 'Grow it, or draw up the trunk and limbs to have them where you see them.',
    reading: 'The tree is being followed through the video …',
  },
  welcome: {
    title: 'Or let it sway: a video, one stroke',
    hint: 'A few seconds of the tree in the wind, and it moves as it was filmed.',
    choose: 'Choose a video',
    advice: 'How to film a tree',
    lead: 'Film the whole tree for 5 to 10 seconds in the wind, from a camera that stands still.',
    formats: 'MP4, MOV, WebM, AVI or GIF, up to one minute.',
  },
  advice: {
    title: 'How to film a tree',
    points: [
      ['A still camera', 'Use a tripod, or lean the phone on something. Do not pan or zoom.'],
      ['A few seconds', 'Five to ten seconds are enough, and one minute is the most that is used.'],
      ['Wind', 'Branches should move visibly, but not blur. A breeze is best.'],
      ['The whole tree', 'From the ground to its top, with a little room around it.'],
      ['A plain background', 'Sky or a far wall. Other trees that sway behind it are hard to tell from it.'],
      ['Good light', 'By day. In the dark no leaf can be followed.'],
      ['One piece', 'Do not cut the video, and do not slow it down.'],
    ] as readonly (readonly [string, string])[],
  },
} as const
