/** Values that were, the one that is, and those that were undone; the latest before and the next after lie at the ends. */
export interface History<T> {
  readonly past: readonly T[]
  readonly present: T
  readonly future: readonly T[]
}

export function begin<T>(present: T): History<T> {
  return { past: [], present, future: [] }
}

/** Go on to a new value; what was undone before is gone. */
export function advance<T>(history: History<T>, next: T): History<T> {
  return next === history.present ? history : { past: [...history.past, history.present], present: next, future: [] }
}

/** Put what `change` gives in the place of every value that was, is or was undone. */
export function throughout<T>({ past, present, future }: History<T>, change: (value: T) => T): History<T> {
  return { past: past.map(change), present: change(present), future: future.map(change) }
}

export function undo<T>({ past, present, future }: History<T>): History<T> {
  return past.length
    ? { past: past.slice(0, -1), present: past.at(-1)!, future: [present, ...future] }
    : { past, present, future }
}

export function redo<T>({ past, present, future }: History<T>): History<T> {
  return future.length
    ? { past: [...past, present], present: future[0]!, future: future.slice(1) }
    : { past, present, future }
}
