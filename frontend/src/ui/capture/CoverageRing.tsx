import { useMemo } from 'preact/hooks'
import { placeUntraced } from '../../preview/capture/placement'
import type { Similarity } from '../../preview/capture/similarity'
import { captureOf, photoDrawnOn } from '../../sheets'
import { text } from '../../text'
import { tracedInSpace } from '../../tracedOn'
import { useStore, useStudio } from '../parts/useStore'
import { directionOf, type Gap, gapsIn, missingDirections, type PlanPhoto, planOf } from './coverage'
import './coverageRing.css'
import { frontOf, treeFrom } from './followMeasured'

const { coverage: words } = text.measured
/** The plan's middle and the ring's radius, in a square of 120 units. */
const [MIDDLE, RADIUS] = [60, 41]
/** How near to the middle and how far from it a photo is drawn, in radii of the ring. */
const [NEAREST, FARTHEST] = [0.72, 1.22]
/** Wider panes show the plan at once. */
const ROOMY = '(width >= 1000px)'

/** A plan of the tree from above with the photos around it, and a sentence that says from where more would help. */
export function CoverageRing() {
  const { captures } = useStudio()
  const capture = useStore(captureOf)
  const chosen = useStore(photoDrawnOn)
  const front = useStore(state => frontOf(state.history.present))
  const answer = useStore(tracedInSpace)
  const { cameras = [], photos = [] } = capture ?? {}
  const tree = useMemo(() => (cameras.length ? frameOf(cameras, front, answer) : null), [cameras, front, answer])
  const plan = useMemo(() => (tree ? planOf(cameras, tree) : []), [cameras, tree])
  const gaps = useMemo(() => gapsIn(plan), [plan])
  const unused = photos.filter(({ used }) => used === false)
  return (
    <details class="overlay coverage" hidden={!plan.length} open={matchMedia(ROOMY).matches}>
      <summary class="button">{words.title}</summary>
      <Plan plan={plan} gaps={gaps} chosen={chosen} choose={photo => captures.choose(photo)} />
      <p>{gaps.length ? words.missing(missingDirections(gaps)) : words.all}</p>
      <ul class="visually-hidden">
        {plan.map(({ photo, azimuth }) => (
          <li key={photo}>{words.photo(photo, directionOf(azimuth))}</li>
        ))}
        {unused.map(({ name }) => (
          <li key={name}>{words.unused(name)}</li>
        ))}
      </ul>
    </details>
  )
}

interface PlanProps {
  readonly plan: readonly PlanPhoto[]
  readonly gaps: readonly Gap[]
  readonly chosen: string | null
  choose(photo: string): void
}

/** The plan itself; the list beside it says the same, and the strip of photos chooses by keyboard. */
function Plan({ plan, gaps, chosen, choose }: PlanProps) {
  return (
    <svg viewBox="0 0 120 120" class="plan" role="img" aria-label={words.plan}>
      <circle class="plan-ring" cx={MIDDLE} cy={MIDDLE} r={RADIUS} />
      {gaps.map(gap => (
        <path class="plan-gap" key={gap.from} d={arcOf(gap)} />
      ))}
      <circle class="plan-tree" cx={MIDDLE} cy={MIDDLE} r={13} />
      <text class="plan-front" x={MIDDLE} y={MIDDLE + 25}>
        {words.front}
      </text>
      {plan.map(place => {
        const [x, y] = onPlan(place.azimuth, Math.min(Math.max(place.distance, NEAREST), FARTHEST))
        return (
          // biome-ignore lint/a11y/noStaticElementInteractions: the strip of photos is the keyboard's way
          <g
            key={place.photo}
            class={place.photo === chosen ? 'plan-photo chosen' : 'plan-photo'}
            onClick={() => choose(place.photo)}
          >
            <title>{words.photo(place.photo, directionOf(place.azimuth))}</title>
            <circle class="plan-reach" cx={x} cy={y} r={9} />
            <circle class="plan-dot" cx={x} cy={y} r={place.photo === chosen ? 5 : 3.4} />
          </g>
        )
      })}
    </svg>
  )
}

/** Return where a direction lies on the plan, which shows the front below; `distance` in radii of the ring. */
function onPlan(azimuth: number, distance: number): [number, number] {
  return [MIDDLE + Math.sin(azimuth) * RADIUS * distance, MIDDLE + Math.cos(azimuth) * RADIUS * distance]
}

function arcOf({ from, to }: Gap): string {
  const [start, end] = [onPlan(from, 1), onPlan(to - 1e-3, 1)]
  return `M${start.join(' ')}A${RADIUS} ${RADIUS} 0 ${to - from > Math.PI ? 1 : 0} 0 ${end.join(' ')}`
}

type Frame = Parameters<typeof placeUntraced>

/** Return what leads to a frame with the tree's root, or what the photos show, at x = z = 0 and the front at +Z. */
function frameOf(cameras: Frame[0], front: Frame[1], answer: ReturnType<typeof tracedInSpace>): Similarity {
  return answer ? treeFrom(answer) : placeUntraced(cameras, front)
}
