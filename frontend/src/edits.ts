/** A point of space in the frame of a capture, in which its cameras are given. */
export type Spot = readonly [x: number, y: number, z: number]

/** An edit of the branches that many photos show; `at` and `from` name the nearest joint. */
export type Edit =
  /** The branch from that joint on goes, with all that leaves it. */
  | { readonly do: 'remove'; readonly at: Spot }
  /** A branch leaves that joint through these points; without a radius it is a share of its parent's. */
  | { readonly do: 'add'; readonly from: Spot; readonly points: readonly Spot[]; readonly radius?: number }
  /** The joint goes elsewhere, with what is beyond it. */
  | { readonly do: 'move'; readonly at: Spot; readonly to: Spot }
  /** The joint gets a radius; those beyond it are scaled alike. */
  | { readonly do: 'radius'; readonly at: Spot; readonly radius: number }
  /** The loose piece at a joint is hung onto another joint. */
  | { readonly do: 'join'; readonly at: Spot; readonly to: Spot }
