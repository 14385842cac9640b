import type { Tool } from '../../state'

type Key = Pick<KeyboardEvent, 'key' | 'ctrlKey' | 'metaKey' | 'altKey' | 'shiftKey'>
/** What a key asks of the page. */
export type Command =
  | Tool
  | 'other'
  | 'thinner'
  | 'thicker'
  | 'undo'
  | 'redo'
  | 'remove'
  | 'save'
  | 'open'
  | 'grow'
  | 'fit'
  | 'actual'
  | 'help'

const PLAIN: Readonly<Record<string, Command>> = {
  c: 'crown',
  b: 'branch',
  m: 'scale',
  v: 'select',
  s: 'other',
  '[': 'thinner',
  ']': 'thicker',
  g: 'grow',
  f: 'fit',
  '1': 'actual',
  '?': 'help',
  delete: 'remove',
}
const WITH_CTRL: Readonly<Record<string, Command>> = { z: 'undo', y: 'redo', s: 'save', o: 'open' }

/** Read a key; null where it asks nothing of the page. */
export function commandOf({ key, ctrlKey, metaKey, altKey, shiftKey }: Key): Command | null {
  if (altKey) return null
  const low = key.toLowerCase()
  if (!ctrlKey && !metaKey) return PLAIN[low] ?? null
  return shiftKey ? (low === 'z' ? 'redo' : null) : (WITH_CTRL[low] ?? null)
}

/** Name a key that goes with the system's command key. */
export function withCtrl(key: string): string {
  return /Mac|iP/.test(navigator.platform) ? `⌘${key.replace('Shift+', '⇧')}` : `Ctrl+${key}`
}
