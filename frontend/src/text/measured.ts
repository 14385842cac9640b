import { plural } from './plural'

/** Directions from the front in eighths of a turn, to the right. */
const DIRECTIONS = [
  'from the front',
  'from the front, to the right',
  'from the right',
  'from behind, to the right',
  'from behind',
  'from behind, to the left',
  'from the left',
  'from the front, to the left',
] as const

function listed(parts: readonly string[]): string {
  return parts.length < 2 ? parts.join('') : `${parts.slice(0, -1).join('; ')}; and ${parts.at(-1)}`
}

/** What is said about a tree that many photos measure: its parts in 3D, the ring of photos, the edits of its branches. */
export const measuredText = {
  parts: {
    group: 'Show',
    names: { cameras: 'Photos', cloud: 'Points', crown: 'Crown', branches: 'Branches' },
    /** What the colours mean. */
    crown: 'Amber parts of the crown are guessed: no photo shows them.',
    branches: 'Amber branches only join those that the photos show.',
  },
  noCamera: 'It is not known where this photo was taken.',
  coverage: {
    title: 'Sides',
    plan: 'Where the photos were taken, from above',
    front: 'front',
    photo: (photo: string, direction: number) => `${photo}: ${DIRECTIONS[direction]}`,
    unused: (photo: string) => `${photo}: not used`,
    all: 'All sides are covered.',
    missing: (directions: readonly number[]) =>
      `More photos would help ${listed(directions.map(direction => DIRECTIONS[direction]!))}.`,
  },
  edits: {
    start: 'Edit branches',
    end: 'Done',
    title: 'Branches',
    tools: { move: 'Move', add: 'Add', join: 'Join' },
    hints: {
      pick: 'Click on a branch to select it.',
      move: 'Drag the marked joint, or change the branch from there on.',
      add: 'Draw a branch: press on the branch that it leaves, and draw outwards.',
      joinPick: 'Click on the piece that hangs in the wrong place.',
      join: 'Now click on the branch where it belongs.',
      waiting: 'Changing the tree …',
    },
    step: { inward: 'Towards the root', outward: 'Towards the tip', across: 'Next branch of the fork' },
    remove: 'Remove',
    removeWhy: 'Remove the branch from the marked joint on (Delete)',
    thickness: 'Thickness',
    unit: 'cm',
    undo: 'Undo',
    redo: 'Redo',
    lost: (count: number, why: string) =>
      `${plural(count, { one: 'One edit was left out', other: '# edits were left out' })}: ${why}.`,
    selected: (thickness: string) => `A branch ${thickness} cm thick is selected.`,
  },
} as const
