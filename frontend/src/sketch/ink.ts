/** Colours on the photo. They do not follow the page's theme: photos have none. */
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
} as const

/** Widths on the screen, CSS px. */
export const WIDTH = {
  line: { crown: 2.25, branch: 1.75, erase: 2, scale: 2 },
  casing: 2.25,
  halo: 11,
  rim: 1.4,
  thinnestWood: 0.8,
  edge: 1,
  shade: 3,
} as const
