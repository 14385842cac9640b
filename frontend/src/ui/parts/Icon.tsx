import type { ICONS } from './icons'

/** A line icon: a path in a square of 24 units. */
export function Icon({ path }: { readonly path: (typeof ICONS)[keyof typeof ICONS] }) {
  return (
    <svg viewBox="0 0 24 24" class="icon" aria-hidden="true">
      <path d={path} />
    </svg>
  )
}
