import { whole } from './numbers'
import { plural } from './plural'

/** What is said of the two sheets, the front's and the left side's. */
export const sheetsText = {
  front: 'Front',
  side: 'Left side',
  /** In which direction each is seen. */
  seen: {
    front: 'Seen from the front',
    side: 'Seen from its left, front at the right',
  },
  seenLong: {
    front: 'You stand in front of the tree.',
    side: 'You stand to the left of the front view. The tree’s front is on the right.',
  },
  canvas: { front: 'Paper to draw the front on', side: 'Paper to draw the left side on' },
  canvasKeys:
    'Arrow keys move the pen. Hold Shift for small steps. Enter puts the pen down or lifts it. B chooses Branch, C Crown. Square brackets change the brush. S goes to the other sheet. Escape cancels the stroke.',
  activated: { front: 'Front sheet.', side: 'Left side sheet.' },
  /** At the lines that run through both sheets. */
  levels: { root: 'ground', top: 'treetop' },
  /** Beside the dotted lines of a side that was drawn with another height. */
  stray: 'drawn to here, will be scaled',
  on: (stroke: string) => `${stroke} (left side)`,
  addPicture: 'Add a photo to draw over',
  openDrawing: 'Open a drawing',
  opened: 'Drawing opened.',
  /** Where a picture is dropped: what comes of it, and what for. */
  drop: {
    lay: ['Add it to this sheet', 'You draw over the photo.'],
    photo: ['Open it as a photo', 'You draw over its tree.'],
    drawing: ['Open it as a drawing', 'You add to its strokes.'],
  },
  remark: (sheet: string, what: string) => `${sheet}: ${what}`,
  /** What was corrected in the picture of a sketch, by the service's codes. */
  corrected: {
    branch_joined: (count: number) => plural(count, { one: '# gap was closed.', other: '# gaps were closed.' }),
    loop_cut: (count: number) =>
      plural(count, { one: '# loop of branches was cut open.', other: '# loops of branches were cut open.' }),
    crown_crosses_itself: () => 'The crown line crosses itself. Everything inside it counts as crown.',
  },
  leftOut: (count: number, most: number) =>
    plural(count, {
      one: `The shortest branch was left out. At most ${whole(most)} can be drawn.`,
      other: `The # shortest branches were left out. At most ${whole(most)} can be drawn.`,
    }),
  hide: 'Hide the photo',
  show: 'Show the photo',
  removePicture: 'Remove the photo',
  close: 'Close this sheet',
  open: 'Draw its left side, too',
  openWhy: 'What you draw there replaces the guessed depth.',
  brushes: {
    group: 'Brush',
    pencil: 'Pencil, automatic thickness',
    fine: 'Fine brush',
    medium: 'Medium brush',
    broad: 'Broad brush',
  },
  hints: {
    trunk: 'Draw the trunk from the ground up, then branches.',
    chooseBranch: 'Choose Branch, then draw the trunk from the ground up.',
    side: 'Now draw its left side on the other sheet.',
    sideHow: 'Without it, the depth is guessed.',
    sideTrunk: 'Draw the trunk again, from the ground line to the treetop line.',
    branches: 'Draw the branches as seen from the left.',
    refine: 'Draw more on either sheet, or grow the tree.',
    mixed: 'Draw the trunk and its branches as seen from the left.',
    mixedGrow: 'Draw more, or grow the tree. This side replaces the guessed depth.',
    how: {
      mouse: 'Drag along each branch outward, or drop a drawing here.',
      touch: 'Draw with your finger. Two fingers move and zoom.',
      pen: 'Draw with the pen, each branch outward.',
    },
  },
  welcome: {
    draw: 'Draw it yourself',
    drawHint: 'Draw two sides on white paper, or open a PNG of dark strokes.',
    examples: 'Or draw a tree from two sides',
    examplesHint: 'Two sketches make one tree, without a photo.',
  },
  tabs: { front: 'Front', side: 'Left side', tree: 'Tree' },
  keys: { other: 'Go to the other sheet', thinner: 'Thinner or wider brush' },
} as const
