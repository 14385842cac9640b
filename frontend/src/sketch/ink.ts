/** A colour for each kind of stroke and mark. */
export type Inks = { readonly [name in keyof typeof INK]: string }

/** Colours over a photo; they do not follow the page's theme, as photos do not either. */
export const INK = {
  foliage: 'rgba(150, 214, 72, 0.22)',
  foliageEdge: 'rgba(226, 250, 176, 0.78)',
  foliageShade: 'rgba(24, 52, 12, 0.3)',
  woodRim: 'rgba(255, 246, 226, 0.92)',
  woodStroked: 'rgba(122, 70, 28, 0.78)',
  woodFound: 'rgba(203, 150, 84, 0.86)',
  crown: '#c9f27a',
  branch: '#ffe2ae',
  erase: '#ffb9a8',
  scale: '#bfe8ff',
  label: 'rgba(20, 28, 34, 0.78)',
  casing: 'rgba(24, 20, 10, 0.6)',
  fault: '#ff4a3d',
  faultHalo: 'rgba(255, 84, 70, 0.6)',
  selected: '#ffffff',
  selectedHalo: 'rgba(34, 140, 255, 0.75)',
  selectedWood: 'rgba(140, 200, 255, 0.4)',
  photoEdge: 'rgba(30, 24, 12, 0.35)',
  hoverHalo: 'rgba(120, 190, 255, 0.5)',
  level: 'rgba(255, 250, 235, 0.6)',
  levelCasing: 'rgba(24, 20, 10, 0.35)',
  levelWords: 'rgba(0, 0, 0, 0)',
  stray: 'rgba(255, 205, 150, 0.9)',
} as const

/** Colours on paper, without casings. Paper is white in the dark theme, too. */
export const PAPER_INK: Inks = {
  ...INK,
  crown: '#5f9a2a',
  branch: '#5b4632',
  casing: 'rgba(255, 253, 248, 0)',
  fault: '#c8281b',
  faultHalo: 'rgba(255, 84, 70, 0.35)',
  selected: '#1769c4',
  selectedHalo: 'rgba(34, 140, 255, 0.28)',
  hoverHalo: 'rgba(70, 150, 240, 0.22)',
  level: 'rgba(120, 104, 72, 0.6)',
  levelCasing: 'rgba(255, 253, 248, 0)',
  levelWords: 'rgba(110, 94, 62, 0.95)',
  stray: 'rgba(196, 110, 30, 0.9)',
}

/** Colours of the paper, and how opaque (0..1) a picture under it shows. */
export const PAPER = { white: '#fffdf8', edge: 'rgba(80, 66, 40, 0.28)', shade: 'rgba(60, 50, 30, 0.16)', veil: 0.5 }

/** Line widths, CSS px. */
export const WIDTH = {
  line: { crown: 2.25, branch: 1.75, erase: 2, scale: 2 },
  casing: 2.25,
  halo: 11,
  rim: 1.4,
  thinnestWood: 0.8,
  edge: 1,
  shade: 3,
} as const
