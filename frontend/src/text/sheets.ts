/** What is said of the two sheets, the front's and the left side's. */
export const sheetsText = {
  front: 'Front',
  side: 'Left side',
  /** In which direction each is seen. */
  seen: {
    front: 'as the viewer stands before it',
    side: 'from its left; viewer at the right',
  },
  seenLong: {
    front: 'You stand before the tree and look at it.',
    side: 'You stand at the tree’s left, as the front shows it. What comes towards you in the front view is on the right here.',
  },
  canvas: { front: 'Paper to draw the front on', side: 'Paper to draw the left side on' },
  canvasKeys:
    'Arrow keys move the pen, with Shift by small steps. Enter sets it down and lifts it up. B takes the branch, C the crown, the brackets a thinner or a wider brush. S goes to the other sheet. Escape drops the stroke.',
  turnedTo: { front: 'The front’s sheet.', side: 'The left side’s sheet.' },
  /** At the lines that run through both sheets. */
  levels: { root: 'ground', top: 'treetop' },
  /** Beside the dotted lines of a side that was drawn with another height. */
  stray: 'drawn to here: it will be fitted',
  on: (stroke: string) => `${stroke}, left side`,
  lay: 'Lay a photo under',
  openDrawing: 'Open a drawing',
  opened: 'Drawing opened.',
  /** Where a picture is dropped: what comes of it, and what for. */
  drop: {
    lay: ['Lay it under this sheet', 'a photo to draw over'],
    photo: ['Open it as a photo', 'to draw over its tree'],
    drawing: ['Open it as a drawing', 'its strokes become yours to draw on'],
  },
  remark: (sheet: string, what: string) => `${sheet}: ${what}`,
  /** What was mended in the picture of a sketch, by the service's codes. */
  mended: {
    branch_joined: (count: number) => (count === 1 ? 'a gap was bridged.' : `${count} gaps were bridged.`),
    loop_cut: (count: number) =>
      count === 1 ? 'a ring of branches was cut open.' : `${count} rings of branches were cut open.`,
    crown_crosses_itself: () => 'the crown line crosses itself; everything inside it was taken.',
  },
  leftOut: (count: number, most: number) =>
    count === 1
      ? `the shortest branch was left out: ${most} can be drawn at most.`
      : `the ${count} shortest branches were left out: ${most} can be drawn at most.`,
  hide: 'Hide the photo',
  show: 'Show the photo',
  lift: 'Take the photo away',
  close: 'Put this sheet away',
  open: 'Draw its left side, too',
  openWhy: 'What you draw there takes the place of the depth that is guessed.',
  brushes: {
    group: 'Brush',
    pencil: 'Pencil: thickness is worked out',
    fine: 'Fine brush',
    medium: 'Medium brush',
    broad: 'Broad brush',
    taken: (brush: string) => `${brush}.`,
  },
  hints: {
    trunk: 'Draw the trunk upward, then branches.',
    takeBranch: 'Take Branch and draw the trunk from the ground up.',
    side: 'Now draw it from its left, on the other sheet.',
    sideHow: 'Else its depth is guessed.',
    sideTrunk: 'Draw the trunk again, from line to line.',
    branches: 'Draw the branches as seen from the left.',
    refine: 'Draw on, on either sheet, or grow the tree.',
    mixed: 'Draw the trunk and its branches as seen from the left.',
    mixedGrow: 'Draw on, or grow the tree: the side stands in for the depth that is guessed.',
    how: {
      mouse: 'Drag, each branch outward; or drop a drawing.',
      touch: 'One finger draws; two move and zoom.',
      pen: 'Draw with the pen, each branch outward.',
    },
  },
  assumed: 'Only the front is drawn: how deep the tree is was guessed.',
  noFront: 'First draw the trunk on the front’s sheet.',
  drawing: 'Drawing',
  welcome: {
    draw: 'Draw it yourself',
    drawHint: 'on white paper, from two sides; or bring a PNG of dark strokes',
    examples: 'Or drawn from two sides',
    examplesHint: 'Two sketches, one tree: no photo needed.',
  },
  tabs: { front: 'Front', side: 'Left side', tree: 'Tree' },
  keys: { other: 'The other sheet', thinner: 'Thinner, wider brush' },
  fruit: {
    label: 'Fruit of your own',
    why: 'A PNG of one fruit with a transparent background, its stalk at the top. Fruits hang among the leaves.',
    choose: 'Choose a fruit',
    shown: 'Your fruit',
    taken: 'Your fruit is taken.',
    removed: 'Your fruit is removed.',
  },
  score: {
    match: (percent: string) => `${percent} of the front’s strokes are in the tree`,
    matchBoth: (front: string, side: string) =>
      front === side
        ? `${front} of the strokes of both sides are in the tree`
        : `${front} of the front’s strokes and ${side} of the side’s are in the tree`,
    /** By the least share of strokes that each needs, the best first. */
    words: [
      [0.98, 'The tree goes where you drew.'],
      [0.9, 'The tree goes nearly everywhere where you drew.'],
      [0, 'The tree leaves some strokes out: let branches begin on those that bear them.'],
    ] as readonly (readonly [number, string])[],
    rows: {
      frontCovered: ['Front’s strokes', 'How many of them the tree covers, seen from the front.'],
      sideCovered: ['Side’s strokes', 'How many of them the tree covers, seen from its left.'],
      frontTrue: ['True to the front', 'How much of its main branches you drew there.'],
      sideTrue: ['True to the side', 'How much of its main branches you drew there.'],
      paired: ['Found on both', 'Branches of the front that one of the side goes with.'],
      inPlanes: ['In two planes', 'Main branches that lie flat in one of the sheets; few is good.'],
    },
  },
} as const
