import type { TracedSkeleton } from '../../src/api/types'

/**
 * A stroked trunk 0-1-2 and a traced branch 3-4-5 from joint 1, which forks at 4 into its continuation 5 and the thinner
 * but longer 6-7; 8 leaves the trunk's tip as another branch.
 */
export const TREE: TracedSkeleton = {
  points: [
    [100, 200],
    [100, 150],
    [100, 100],
    [110, 150],
    [140, 140],
    [170, 150],
    [150, 120],
    [150, 60],
    [108, 92],
  ],
  radii: [10, 8, 6, 4, 3, 2, 1.5, 1, 2],
  parents: [-1, 0, 1, 1, 3, 4, 4, 6, 2],
  stroke: [0, 0, 0, -1, -1, -1, -1, -1, -1],
}
