import './sapling.css'

/** In a square of 120 units. */
const LINES =
  'M60 112C59 92 61 78 60 58M60 84C54 78 47 74 40 72M60 74C66 67 73 63 80 62M60 62C55 54 52 47 51 39M60 60C64 52 68 46 72 41' +
  'M36 112c10-4 38-4 48 0M60 14c-9 0-16 5-19 12-9 1-16 8-16 17 0 4 1 7 3 10-5 3-8 8-8 14 0 8 6 14 13 15M60 14c9 0 16 5 19 12 9 1 16 8 16 17 0 4-1 7-3 10 5 3 8 8 8 14 0 8-6 14-13 15'

/** A young tree in dashed pencil lines: it stands where there is no tree yet. */
export function Sapling() {
  return (
    <svg viewBox="0 0 120 120" class="icon sapling" aria-hidden="true">
      <path d={LINES} />
    </svg>
  )
}
