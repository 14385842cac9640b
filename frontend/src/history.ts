/** Undo history: `past` ends with the value that an undo restores, `future` begins with the one that a redo restores. */
export interface History<T> {
  readonly past: readonly T[]
  readonly present: T
  readonly future: readonly T[]
}

/** Return a history of one value. */
export function begin<T>(present: T): History<T> {
  return { past: [], present, future: [] }
}

/** Return the history with a new present value; what was undone can no longer be redone. */
export function advance<T>(history: History<T>, next: T): History<T> {
  return next === history.present ? history : { past: [...history.past, history.present], present: next, future: [] }
}

/** Return the history with every value replaced by what `change` returns for it. */
export function mapHistory<T>({ past, present, future }: History<T>, change: (value: T) => T): History<T> {
  return { past: past.map(change), present: change(present), future: future.map(change) }
}

/** Return the history one step back; unchanged where there is no past. */
export function undo<T>({ past, present, future }: History<T>): History<T> {
  return past.length
    ? { past: past.slice(0, -1), present: past.at(-1)!, future: [present, ...future] }
    : { past, present, future }
}

/** Return the history one step forward; unchanged where nothing was undone. */
export function redo<T>({ past, present, future }: History<T>): History<T> {
  return future.length
    ? { past: [...past, present], present: future[0]!, future: future.slice(1) }
    : { past, present, future }
}
