/** Half the side of the picture, and how far the places are from the tree. */
const MIDDLE = 110
const RADIUS = 88
const PLACES = 20
/** Half the angle that one photo takes in, radians, and how far its view reaches. */
const HALF_VIEW = 0.34
const REACH = 132

/** A plan of a tree from above, with the places around it from which photos are taken; two neighbours show their views. */
export function PhotoRing({ label }: { readonly label: string }) {
  const places = Array.from({ length: PLACES }, (_, index) => (2 * Math.PI * (index + 0.5)) / PLACES)
  return (
    <svg viewBox={`0 0 ${2 * MIDDLE} ${2 * MIDDLE}`} class="photo-ring" role="img" aria-label={label}>
      {[places[4]!, places[5]!].map(angle => (
        <path key={angle} class="ring-view" d={viewFrom(angle)} />
      ))}
      <circle class="ring-path" cx={MIDDLE} cy={MIDDLE} r={RADIUS} />
      <path class="ring-crown" d={crown()} />
      <circle class="ring-trunk" cx={MIDDLE} cy={MIDDLE} r={4} />
      {places.map(angle => (
        <path key={angle} class="ring-place" d={eyeAt(angle)} />
      ))}
    </svg>
  )
}

/** Return the wedge that a photo from this angle takes in. */
function viewFrom(angle: number): string {
  const [left, right] = [-HALF_VIEW, HALF_VIEW].map(turn => ahead(angle, REACH, turn))
  return `M${around(angle, RADIUS)}L${left}L${right}Z`
}

/** Return a small camera that looks at the tree. */
function eyeAt(angle: number): string {
  const [tip, left, right] = [ahead(angle, 1, 0), ahead(angle, -8, 0.55), ahead(angle, -8, -0.55)]
  return `M${tip}L${left}L${right}Z`
}

/** Return a crown from above: a round line with lobes. */
function crown(): string {
  const points = Array.from({ length: 60 }, (_, index) => {
    const angle = (2 * Math.PI * index) / 60
    return around(angle, 38 + 3.5 * Math.sin(7 * angle) + 2 * Math.sin(3 * angle + 1))
  })
  return `M${points.join('L')}Z`
}

/** Return the place at a distance from the tree, at an angle. */
function around(angle: number, distance: number): string {
  return spot(MIDDLE + distance * Math.cos(angle), MIDDLE + distance * Math.sin(angle))
}

/** Return the place at a distance ahead of a photo's place, turned from its direction of view. */
function ahead(angle: number, distance: number, turn: number): string {
  const [x, y] = [MIDDLE + RADIUS * Math.cos(angle), MIDDLE + RADIUS * Math.sin(angle)]
  return spot(x - distance * Math.cos(angle + turn), y - distance * Math.sin(angle + turn))
}

function spot(x: number, y: number): string {
  return `${x.toFixed(1)} ${y.toFixed(1)}`
}
