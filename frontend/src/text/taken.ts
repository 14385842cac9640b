/** What is said of what a photo's tree is taken for. */
export const takenText = {
  label: 'What the tree is taken for',
  menus: { foliage: 'Kind of tree', form: 'Form of the tree' },
  question: 'What kind of tree is this?',
  questionWhy: (kind: string) => `The photo leaves it open. For now: ${kind}.`,
  /** What stands on the chip before a kind, by where it comes from, and before a form. */
  leads: { photo: 'Taken for: ', species: 'Species: ', settings: 'Chosen: ', form: 'Form: ' },
  sureness: { sure: 'very sure', likely: 'fairly sure', unsure: 'not sure' },
  asInPhoto: (name: string) => `As in the photo (${name})`,
  asSpecies: (species: string) => `As the species (${species})`,
  changed: (words: string) => `${words}. The tree grows again.`,
} as const
