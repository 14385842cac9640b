import type { CameraInfo, Cloud } from '../../api/types'
import type { Branches } from '../../branches'
import type { Similarity } from './similarity'

type Point = readonly [number, number, number]

/** The surface of a measured crown in a capture's frame; `guessed` tells for each point whether no photo shows it. */
export interface CrownSurface {
  readonly points: readonly Point[]
  readonly triangles: readonly Point[]
  readonly guessed: readonly boolean[]
}

/** What many photos say about a tree, in the frame of their capture. */
export interface Measured {
  /** The cameras of the photos that are used. */
  readonly cameras: readonly CameraInfo[]
  readonly cloud: Cloud | null
  /** The photo that the tree's front is seen in, as far as it is known. */
  readonly front: string | null
  /** What was found for the strokes; null before there are any. */
  readonly tree: {
    readonly branches: Branches
    readonly crown: CrownSurface
    /** Leads to the frame of trees and GLBs, metres. */
    readonly treeFromCapture: Similarity
  } | null
}

/** The parts of what was measured that are shown or hidden. */
export const PARTS = ['cameras', 'cloud', 'crown', 'branches'] as const
export type Part = (typeof PARTS)[number]
