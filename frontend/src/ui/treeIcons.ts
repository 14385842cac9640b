/** Line icons of the tree's side of the page, each drawn in a square of 24 units. */
export const DICE =
  'M5 4h14a1 1 0 0 1 1 1v14a1 1 0 0 1-1 1H5a1 1 0 0 1-1-1V5a1 1 0 0 1 1-1zM8.5 8.5h.01M15.5 8.5h.01M12 12h.01M8.5 15.5h.01M15.5 15.5h.01'
export const SLIDERS = 'M4 7h9M17 7h3M4 17h3M11 17h9M15 4.8v4.4M9 14.8v4.4'
export const DOWNLOAD = 'M12 4v11M7.5 10.5 12 15l4.5-4.5M5 20h14'
export const DOWN = 'M7 10l5 5 5-5'
export const LEAF = 'M5 19c0-9 5-14 15-14 0 10-5 15-12 14M5 20c2-5 5-8 9-10'
export const PLUS = 'M12 6v12M6 12h12'
export const MINUS = 'M6 12h12'
export const LINK =
  'M10 14a4 4 0 0 0 5.7 0l3.1-3.1a4 4 0 0 0-5.7-5.7L12 6.300M14 10a4 4 0 0 0-5.700 0l-3.100 3.100a4 4 0 0 0 5.700 5.700L12 17.700'
export const PENCIL = 'M4 20l1-4L16 5l3 3L8 19l-4 1M14 7l3 3'
export const BIN = 'M5 7h14M10 7V4.500h4V7M7 7l.8 12.500h8.400L17 7M10.500 11v5M13.500 11v5'
export const TREE_FILE =
  'M12 21v-8M12 16l-3-2.500M12 15l3.500-3M12 3c4 0 7 3 7 6.500S16 16 12 16s-7-3-7-6.500S8 3 12 3z'
export const PICTURE = 'M4 5h16v14H4zM4 16l5-5 4 4 2.500-2.500L20 17M15.500 9h.01'
export const BOX = 'M4 8l8-4 8 4v8l-8 4-8-4zM4 8l8 4 8-4M12 12v8'
export const STROKE = 'M4 18c5 2 4-8 8-8s2 8 8-4'
export const PAPER = 'M7 3h7l4 4v14H7zM14 3v4h4'
