import { text } from '../../text'
import { type DrawnTree, drawnTree, LEVELS, type Leaf, outline, type Twig } from './drawnTree'
import './illustration.css'

const SHADES = 5
/** Branches up to this level are drawn one by one, finer ones appear together. */
const LIMBS = 2
const GROUND = 'M70 380c50-5 96-7 150-6 60 1 104 2 152 5M120 388c40-3 66-3 96-3M262 387c24 0 44 0 66 2'
const TRUNK = 'M219 378c3-30-4-58 0-92 2-22 6-38 4-62'

const TREE = drawnTree()

/** What the page is about: a line around the leaves, a line up the trunk, and the tree that grows from them. */
export function Illustration() {
  return (
    <svg viewBox="14 34 420 364" class="art" role="img" aria-label={text.welcome.illustration}>
      <path class="art-ground" d={GROUND} />
      <g class="art-wood">
        <Wood {...TREE} />
      </g>
      <Foliage {...TREE} />
      <path class="art-stroke art-crown" d={outline(TREE)} pathLength={1} />
      <path class="art-stroke art-trunk" d={TRUNK} pathLength={1} />
    </svg>
  )
}

function Wood({ twigs }: DrawnTree) {
  const limbs = twigs.filter(({ level }) => level <= LIMBS)
  const finer = Array.from({ length: LEVELS - LIMBS }, (_, index) =>
    twigs.filter(({ level }) => level === LIMBS + 1 + index),
  )
  return (
    <>
      {limbs.map(limb => (
        <Curves key={limb} twigs={[limb]} kind="art-limb" />
      ))}
      {finer.map(twigs => (
        <Curves key={twigs[0]!.level} twigs={twigs} kind="art-twigs" />
      ))}
    </>
  )
}

/** Twigs of one level as one path. */
function Curves({ twigs, kind }: Pick<DrawnTree, 'twigs'> & { readonly kind: string }) {
  const { level, width } = twigs[0]!
  const d = twigs.map(curve).join('')
  return <path d={d} class={`${kind} art-level-${level}`} stroke-width={width.toFixed(2)} pathLength={1} />
}

function Foliage({ leaves }: DrawnTree) {
  const shades = Array.from({ length: SHADES }, (_, shade) => leaves.filter((_, index) => index % SHADES === shade))
  return (
    <>
      {shades.map((leaves, shade) => (
        <path key={leaves} class={`art-leaf art-leaf-${shade}`} d={leaves.map(blade).join('')} />
      ))}
    </>
  )
}

function curve({ from, bend, to }: Twig): string {
  return `M${spot(...from)}Q${spot(...bend)} ${spot(...to)}`
}

function blade({ at: [x, y], turn, size }: Leaf): string {
  const [right, down] = [Math.cos(turn) * size, Math.sin(turn) * size]
  const place = (along: number, aside: number) =>
    spot(x + along * right - aside * down, y + along * down + aside * right)
  return `M${place(0, 0)}Q${place(4.5, 4.5)} ${place(10, 0)}Q${place(5, -3)} ${place(0, 0)}`
}

function spot(x: number, y: number): string {
  return `${x.toFixed(1)} ${y.toFixed(1)}`
}
