import type { Model } from '../api/types'

const TREE = /^tree\.(?:v(\d+)\.)?(.+)$/

/** The part of a model's report about its trees and their files. */
interface Report {
  readonly variants?: readonly { readonly score?: Model['score']; readonly counts?: Readonly<Record<string, number>> }[]
  readonly files?: Readonly<Record<string, number>>
}

/** A file of one of a model's trees: the tree's number, from 1, and the rest of its name, such as `lod1.glb`. */
export interface TreeFile {
  readonly name: string
  readonly variant: number
  readonly what: string
  readonly url: string
}

/** Return the files of a model's trees, without files of the model itself, such as its project. */
export function treeFiles({ files }: Model): TreeFile[] {
  return Object.entries(files).flatMap(([name, url]) => {
    const found = TREE.exec(name)
    return found ? [{ name, variant: Number(found[1] ?? 1), what: found[2]!, url }] : []
  })
}

/** Return how many trees a model has: as many as there are GLBs. */
export function variantsOf(model: Model): number {
  return treeFiles(model).filter(({ what }) => what === 'glb').length
}

/** Return the address of a tree's GLB, by its number from 1; undefined where there is none. */
export function treeOf(model: Model, variant: number): string | undefined {
  return model.files[nameOf(variant)]
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
