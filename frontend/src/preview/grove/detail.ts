/** How a tree is drawn: with all its leaves, with fewer and larger ones, or as a picture. */
export type Detail = 'near' | 'middle' | 'far'

/** A tree as it is seen: its height on the screen, px; not seen where it is out of view. */
export interface Seen {
  readonly height: number
  readonly isInView: boolean
}

/** How many trees are drawn in a detail at most, and how high they are on the screen at least, px. */
export interface Budget {
  readonly near: number
  readonly middle: number
}

const LEAST = { near: 420, middle: 150 }
/** What a graphics processor draws in time, and the processor itself. */
export const BUDGET: Budget = { near: 3, middle: 24 }
export const SOFTWARE_BUDGET: Budget = { near: 0, middle: 4 }

/** Return how each tree is drawn: the highest on the screen in most detail, within the budget; null where it is not seen. */
export function detailsOf(trees: readonly Seen[], budget: Budget): (Detail | null)[] {
  const left = { ...budget }
  const details: (Detail | null)[] = trees.map(({ isInView }) => (isInView ? 'far' : null))
  const order = trees.map((_, at) => at).filter(at => trees[at]!.isInView)
  order.sort((one, other) => trees[other]!.height - trees[one]!.height)
  for (const at of order) {
    const detail = (['near', 'middle'] as const).find(one => left[one] > 0 && trees[at]!.height >= LEAST[one])
    if (!detail) continue
    left[detail]--
    details[at] = detail
  }
  return details
}
