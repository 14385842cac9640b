import type { Model } from '../api/types'

const TREE = /^tree\.(?:v(\d+)\.)?(?:s(\d+)\.)?(.+)$/
/** The file of all siblings as one scene. */
const GROVE = 'tree.grove.glb'

/** The part of a model's report about its trees and their files. */
interface Report {
  readonly variants?: readonly { readonly score?: Model['score']; readonly counts?: Readonly<Record<string, number>> }[]
  readonly files?: Readonly<Record<string, number>>
}

/** A file of one of a model's trees: the tree's number, from 1, its sibling's (0: its own), and the rest of its name, such as `lod1.glb`. */
export interface TreeFile {
  readonly name: string
  readonly variant: number
  readonly sibling: number
  readonly what: string
  readonly url: string
}

/** Return the files of a model's trees, without files of the model itself, such as its project. */
export function treeFiles({ files }: Model): TreeFile[] {
  return Object.entries(files).flatMap(([name, url]) => {
    const found = TREE.exec(name)
    if (!found) return []
    const [, variant = 1, sibling = 0, what] = found
    return [{ name, variant: Number(variant), sibling: Number(sibling), what: what!, url }]
  })
}

/** Return how many trees a model has: as many as there are GLBs. */
export function variantsOf(model: Model): number {
  return treeFiles(model).filter(({ what, sibling }) => what === 'glb' && sibling === 0).length
}

/** Return how many siblings a model's tree has. */
export function siblingsOf(model: Model): number {
  return treeFiles(model).filter(({ what, sibling }) => what === 'glb' && sibling > 0).length
}

/** Return the address of the scene that all siblings stand in; undefined where there is none. */
export function groveOf(model: Model): string | undefined {
  return model.files[GROVE]
}

/** Return the address of a tree's GLB, by its number from 1, or of its sibling's; undefined where there is none. */
export function treeOf(model: Model, variant: number, sibling = 0): string | undefined {
  return model.files[sibling ? `tree.s${sibling}.glb` : nameOf(variant)]
}

/** Return a model with the score and counts of one of its trees, by its number from 1. */
export function withVariant(model: Model, variant: number): Model {
  const { variants, files } = (model.report ?? {}) as Report
  const tree = variants?.[variant - 1]
  if (!tree || variant === 1) return model
  const bytes = files?.[nameOf(variant)]
  const counts = { ...tree.counts, ...(bytes !== undefined && { bytes }) }
  return { ...model, score: tree.score ?? model.score, report: { ...model.report, counts } }
}

function nameOf(variant: number): string {
  return variant === 1 ? 'tree.glb' : `tree.v${variant}.glb`
}
