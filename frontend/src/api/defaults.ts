import type { components } from './schema'

/** Written by `make types` from the API's document. */
export const DEFAULT_SETTINGS: Required<components['schemas']['ModelSettings']> = {
  height: 10,
  library: 'auto',
  iterations: 300,
  variants: 1,
  siblings: 0,
  grove: false,
  lift: 'auto',
  form: 'auto',
  species: 'auto',
  season: 'photo',
  foliage: 'auto',
  light: 'photo',
  edge: 'complete',
  leaf_size: 1,
  leaf_density: 1,
  wind: 'none',
  lod: 'none',
  compress: false,
  files: [],
}
