import { text } from '../text'
import { svg } from './dom'
import { type DrawnTree, drawnTree, LEVELS, type Leaf, outline, type Twig } from './drawnTree'
import './illustration.css'

const SHADES = 5
/** Branches up to this level are drawn one by one, finer ones appear together. */
const LIMBS = 2

/** Draw what the page is about: a line around the leaves, a line up the trunk, and the tree that comes of them. */
export function illustration(): SVGElement {
  const tree = drawnTree()
  return svg(
    'svg',
    { viewBox: '14 34 420 364', class: 'art', role: 'img', 'aria-label': text.welcome.illustration },
    svg('path', {
      class: 'art-ground',
      d: 'M70 380c50-5 96-7 150-6 60 1 104 2 152 5M120 388c40-3 66-3 96-3M262 387c24 0 44 0 66 2',
    }),
    svg('g', { class: 'art-wood' }, ...wood(tree)),
    ...foliage(tree),
    svg('path', { class: 'art-stroke art-crown', d: outline(tree), pathLength: 1 }),
    svg('path', { class: 'art-stroke art-trunk', d: 'M219 378c3-30-4-58 0-92 2-22 6-38 4-62', pathLength: 1 }),
  )
}

function wood({ twigs }: DrawnTree): SVGElement[] {
  const line = (own: readonly Twig[], kind: string) => {
    const { level, width } = own[0]!
    const d = own.map(curve).join('')
    return svg('path', { d, class: `${kind} art-level-${level}`, 'stroke-width': width.toFixed(2), pathLength: 1 })
  }
  const limbs = twigs.filter(({ level }) => level <= LIMBS).map(twig => line([twig], 'art-limb'))
  const finer = Array.from({ length: LEVELS - LIMBS }, (_, index) => {
    const own = twigs.filter(({ level }) => level === LIMBS + 1 + index)
    return line(own, 'art-twigs')
  })
  return [...limbs, ...finer]
}

function foliage({ leaves }: DrawnTree): SVGElement[] {
  return Array.from({ length: SHADES }, (_, shade) => {
    const own = leaves.filter((_, index) => index % SHADES === shade)
    return svg('path', { class: `art-leaf art-leaf-${shade}`, d: own.map(blade).join('') })
  })
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
